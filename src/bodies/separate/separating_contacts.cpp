#include "bodies/separate/separating_contacts.h"

#include <algorithm>
#include <array>

#include "geometry/barycentric.h"
#include "geometry/vec.h"

namespace sdm::separate {
namespace {

// Contacts that are farther apart than the nearest one by this fraction of the translation and of the size of
// the bodies belong to the same touch.
constexpr double kGapOfTranslation = 2e-3, kGapOfSize = 1e-6;

// How far O1 is to go along the normal of a contact of which t is free. The points may be farther apart:
// those of the exit, on a wall beyond the one that O1 has left by, and those of surfaces that touch after t,
// whose direction is that of a face.
double depth_along(const Contact& c, const Vec3& t) {
  return std::min(dot(c.normal, c.point2 - c.point1), dot(c.normal, t));
}

// The contact of the closest points after the translation, along it.
Contact exit_contact(const std::array<shape::PosedBody, 2>& bodies, const pairs::FacePair& faces,
                     const std::array<Vec3, 2>& closest, const Vec3& t) {
  Contact exit{.point1 = closest[0] - t,
               .point2 = closest[1],
               .normal = normalized(t) + Vec3{},
               .id = ProximityQuery::kExitContact};
  exit.depth = depth_along(exit, t);
  for (int body = 0; body < 2; ++body) {
    if (faces[body] == kNone) continue;
    const Mesh& mesh = internals(bodies[body].body().sites()).mesh;
    const auto& [a, b, c] = mesh.triangles[faces[body]];
    const Vec3 p = inverse(bodies[body].pose().map)(closest[body]);
    exit.on[body] = {faces[body], barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], p)};
  }
  return exit;
}

double size_of(const shape::PosedBody& o1, const shape::PosedBody& o2) {
  if (o1.body().half_space()) return diagonal(o2.box());
  if (o2.body().half_space()) return diagonal(o1.box());
  Box box = o1.box();
  extend(box, o2.box());
  return diagonal(box);
}

// Both bodies after the translation.
std::array<shape::PosedBody, 2> moved(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                      const SeparatingTranslation& out) {
  std::array bodies{o1, o2};
  bodies[0].set_pose(Transform::translation(out.translation) * o1.pose().transform());
  return bodies;
}

// How far apart points may be that belong to a touch after the translation, whose nearest points are `apart`.
double distance_of_touch(double apart, const SeparatingTranslation& out, double size) {
  return apart + kGapOfTranslation * out.value + kGapOfSize * size;
}

}  // namespace

void SeparatingContacts::find(const shape::PosedBody& o1, const shape::PosedBody& o2,
                              const SeparatingTranslation& out, const ContactFilter& filter,
                              std::optional<double> apart) {
  contacts_.clear();
  if (find_of_convex(o1, o2, out)) return;
  const double size = size_of(o1, o2);
  const std::array bodies = moved(o1, o2, out);
  apart_.begin(bodies[0], bodies[1]);
  const double max_distance = distance_of_touch(apart ? *apart : apart_.separation().value, out, size);
  const std::optional<Contact> exit = exit_after(bodies, out, max_distance);
  const std::span<const Contact> all = apart_.contacts_within(contact_margin_ + max_distance);
  add_after(filter ? filter(bodies, all) : all, out.translation);
  sort_after(exit, size);
}

std::optional<Contact> SeparatingContacts::exit_of(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                                   const SeparatingTranslation& out,
                                                   std::optional<double> apart) {
  if (const std::span<const Contact> patch = patch_of(o1, o2, out); !patch.empty()) return patch.front();
  const std::array bodies = moved(o1, o2, out);
  apart_.begin(bodies[0], bodies[1]);
  const double nearest = apart ? *apart : apart_.separation().value;
  return exit_after(bodies, out, distance_of_touch(nearest, out, size_of(o1, o2)));
}

// The contact of the closest points after the translation; none if they are farther apart than that.
std::optional<Contact> SeparatingContacts::exit_after(const std::array<shape::PosedBody, 2>& bodies,
                                                      const SeparatingTranslation& out, double max_distance) {
  if (!apart_.surfaces_within(max_distance)) return {};
  const std::array<Vec3, 2>& closest = *apart_.separation().witness;
  return exit_contact(bodies, apart_.closest_faces(), closest, out.translation);
}

// The patch of convex solids, whose deepest contact is the one of the closest points after the translation;
// empty for other bodies.
std::span<const Contact> SeparatingContacts::patch_of(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                                      const SeparatingTranslation& out) {
  if (!o1.body().has_support() || !o2.body().has_support()) return {};
  const double size = size_of(o1, o2);
  const Vec3 normal = normalized(out.translation);
  return patch_.find(o1, o2, normal, dot(normal, out.translation), size, kGapOfSize * size);
}

bool SeparatingContacts::find_of_convex(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                        const SeparatingTranslation& out) {
  const std::span<const Contact> patch = patch_of(o1, o2, out);
  if (patch.empty()) return false;
  for (const Contact& contact : patch)
    if (contact.depth > -contact_margin_) contacts_.push_back(contact);
  Contact exit = patch.front();
  exit.id = ProximityQuery::kExitContact;
  sort_after(exit, size_of(o1, o2));
  return true;
}

// After the translation t, contact i lets O1 move where n_i·x ≥ −g_i, with its normal n_i and the gap g_i
// there. So before it, the distance to go along n_i is n_i·t − g_i.
void SeparatingContacts::add_after(std::span<const Contact> contacts, const Vec3& t) {
  for (Contact c : contacts) {
    c.point1 = c.point1 - t;
    c.normal += Vec3{};  // no −0
    c.depth = depth_along(c, t);
    if (c.depth > -contact_margin_) contacts_.push_back(c);
  }
}

// Sorts the contacts, after the exit, which is a patch by itself.
void SeparatingContacts::sort_after(const std::optional<Contact>& exit, double size) {
  order_.sort(contacts_, kGapOfSize * size);
  if (!exit) return;
  for (Contact& c : contacts_) ++c.patch;
  contacts_.insert(contacts_.begin(), *exit);
}

void SeparatingContacts::keep_per_patch(std::size_t most) {
  const std::span<const Contact> all = contacts_;
  std::size_t kept = 0;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].patch == all[begin].patch) ++end;
    choose(all.subspan(begin, end - begin), most);
    for (std::size_t i = begin; i < end; ++i)
      if (chosen_[i - begin] != 0) contacts_[kept++] = contacts_[i];
  }
  contacts_.resize(kept);
}

// The deepest contact of a patch, and then each time the one farthest from those that are chosen.
void SeparatingContacts::choose(std::span<const Contact> patch, std::size_t most) {
  chosen_.assign(patch.size(), patch.size() <= most ? 1 : 0);
  if (patch.size() <= most) return;
  distances_.assign(patch.size(), kInfinity);
  std::size_t next = 0;  // the deepest
  for (std::size_t count = 0; count < most; ++count) {
    chosen_[next] = 1;
    for (std::size_t i = 0; i < patch.size(); ++i)
      distances_[i] = std::min(distances_[i], squared_norm(patch[i].point2 - patch[next].point2));
    next = std::ranges::max_element(distances_) - distances_.begin();
    // The rest is at points that are kept: the next deepest.
    if (distances_[next] == 0) next = std::ranges::find(chosen_, 0) - chosen_.begin();
  }
}

}  // namespace sdm::separate
