#include "proximity/separate/separating_contacts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "geometry/barycentric.h"
#include "geometry/vec.h"

namespace sdm::separate {
namespace {

// Contacts that are farther apart than the nearest one by this fraction of the translation and of the size of
// the bodies belong to the same touch.
constexpr double kGapOfTranslation = 2e-3, kGapOfSize = 1e-6;

// Sorted by patch, that with the deepest contact first, and by depth.
void sort_contacts(std::vector<Contact>& contacts) {
  std::map<std::uint32_t, double> deepest;
  for (const Contact& c : contacts) {
    const auto [found, added] = deepest.try_emplace(c.patch, c.depth);
    if (!added) found->second = std::max(found->second, c.depth);
  }
  std::ranges::stable_sort(contacts, [&](const Contact& a, const Contact& b) {
    const double of_a = deepest.at(a.patch), of_b = deepest.at(b.patch);
    if (of_a != of_b) return of_a > of_b;
    if (a.patch != b.patch) return a.patch < b.patch;
    return a.depth > b.depth;
  });
  std::map<std::uint32_t, std::uint32_t> number;
  for (Contact& c : contacts)
    c.patch = number.try_emplace(c.patch, static_cast<std::uint32_t>(number.size())).first->second;
}

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
    const Mesh& mesh = internals(bodies[body].body().sites()).mesh;
    const auto& [a, b, c] = mesh.triangles[faces[body]];
    const Vec3 p = inverse(bodies[body].pose().map)(closest[body]);
    exit.on[body] = {faces[body], barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], p)};
  }
  return exit;
}

}  // namespace

// After the translation t, contact i lets O1 move where n_i·x ≥ −g_i, with its normal n_i and the gap g_i
// there. So before it, the distance to go along n_i is n_i·t − g_i.
std::vector<Contact> contacts_after(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                    const SeparatingTranslation& out, double contact_margin,
                                    const ContactFilter& filter) {
  Box box = o1.box();
  extend(box, o2.box());
  const Vec3& t = out.translation;
  std::array bodies{o1, o2};
  bodies[0].set_pose(Transform::translation(t) * o1.pose().transform());
  pair::PairAnswers apart(0, std::nullopt);
  apart.begin(bodies[0], bodies[1]);
  pair::PairAnswers answers(
      contact_margin + apart.separation().value + kGapOfTranslation * out.value + kGapOfSize * diagonal(box),
      std::nullopt);
  const pairs::FacePair closest = apart.known().closest_faces;
  answers.begin(bodies[0], bodies[1], {.closest_faces = closest});
  std::vector<Contact> contacts{exit_contact(bodies, closest, *apart.separation().witness, t)};
  for (Contact c : filter ? filter(bodies, answers.contacts()) : answers.contacts()) {
    c.point1 = c.point1 - t;
    c.normal += Vec3{};  // no −0
    c.depth = depth_along(c, t);
    c.patch += 1;  // the exit is one by itself
    if (c.depth > -contact_margin) contacts.push_back(c);
  }
  sort_contacts(contacts);
  return contacts;
}

void keep_per_patch(std::vector<Contact>& contacts, std::size_t most) {
  std::vector<Contact> kept;
  for (std::size_t begin = 0, end = 0; begin < contacts.size(); begin = end) {
    while (end < contacts.size() && contacts[end].patch == contacts[begin].patch) ++end;
    if (end - begin <= most) {
      kept.insert(kept.end(), contacts.begin() + begin, contacts.begin() + end);
      continue;
    }
    std::vector<double> apart(end - begin, std::numeric_limits<double>::infinity());
    std::vector<bool> chosen(end - begin);
    std::size_t next = 0;  // the deepest
    for (std::size_t count = 0; count < most; ++count) {
      chosen[next] = true;
      for (std::size_t i = 0; i < apart.size(); ++i)
        apart[i] =
            std::min(apart[i], squared_norm(contacts[begin + i].point2 - contacts[begin + next].point2));
      next = std::ranges::max_element(apart) - apart.begin();
      // The rest is at points that are kept: the next deepest.
      if (apart[next] == 0) next = std::ranges::find(chosen, false) - chosen.begin();
    }
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i]) kept.push_back(contacts[begin + i]);
  }
  contacts = std::move(kept);
}

}  // namespace sdm::separate
