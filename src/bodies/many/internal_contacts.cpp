#include "bodies/many/internal_contacts.h"

#include <algorithm>
#include <cmath>

#include "closest/single_point.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::bodies {
namespace {

constexpr double kAtCorner = 1e-6;  // a smaller weight is that of rounding
constexpr double kFlat = 1e-3;      // the sine of the angle between faces in a plane, at most
constexpr double kAlong = 0.996;    // the cosine of 5°: a direction along a normal
// How far beyond a face another body covers it, in units of the size of the body: more than the gaps between
// tiles.
constexpr double kBeyond = 1e-3;

double diagonal_of(const shape::PosedBody& body) {
  return norm(body.body().box().upper - body.body().box().lower);
}

// Whether the edge is convex, or has not two faces with normals. Of a surface without an inside, either side
// may be the outer one.
bool may_be_convex(const sites::SitesData& sites, std::uint32_t edge) {
  const std::span<const std::uint32_t> faces = sites.topology.edge_faces(edge);
  if (faces.size() != 2 || sites.sliver[faces[0]] || sites.sliver[faces[1]]) return true;
  const auto& [a, b] = sites.topology.edges[edge];
  for (const std::uint32_t corner : sites.mesh.triangles[faces[1]]) {
    if (corner == a || corner == b) continue;
    // Perpendicular to the edge: where the corner at its end is sharp, a side of the face is nearly along it.
    const Vec3 along = normalized(sites.mesh.positions[b] - sites.mesh.positions[a]);
    const Vec3 side = sites.mesh.positions[corner] - sites.mesh.positions[a];
    const double sine = dot(sites.normals.face[faces[0]], normalized(side - dot(side, along) * along));
    return sites.is_solid() ? sine < -kFlat : std::abs(sine) > kFlat;
  }
  return true;
}

// Finds the faces around the vertex or at the edge that the point is on, or its face.
void find_faces(const sites::SitesData& sites, const SurfacePoint& point, InternalContacts::Around& around) {
  const Triangle& corners = sites.mesh.triangles[point.face];
  int count = 0, largest = 0, least = 0;
  for (int i = 0; i < 3; ++i) {
    count += point.barycentric[i] > kAtCorner;
    if (point.barycentric[i] > point.barycentric[largest]) largest = i;
    if (point.barycentric[i] <= point.barycentric[least]) least = i;
  }
  around.faces.assign(1, point.face);
  around.flat = false;
  if (count == 3 || sites.topology.ignored(point.face)) return;
  if (count == 2) {
    const std::uint32_t edge = sites.topology.face_edges[point.face][(least + 1) % 3];
    const std::span<const std::uint32_t> faces = sites.topology.edge_faces(edge);
    around.faces.assign(faces.begin(), faces.end());
    around.flat = !may_be_convex(sites, edge);
    return;
  }
  const std::span<const std::uint32_t> faces = sites.vertex_faces.of(corners[largest]);
  around.faces.assign(faces.begin(), faces.end());
  around.flat = std::ranges::all_of(around.faces, [&](std::uint32_t face) {
    return std::ranges::all_of(sites.topology.face_edges[face], [&](std::uint32_t edge) {
      const auto& [a, b] = sites.topology.edges[edge];
      return (a != corners[largest] && b != corners[largest]) || !may_be_convex(sites, edge);
    });
  });
}

}  // namespace

void InternalContacts::follow(std::span<const shape::PosedBody> bodies, const PairFilter& filter) {
  bodies_ = bodies;
  fixed_.clear();
  boxes_.clear();
  neighbours_.clear();
  for (std::uint32_t b = 0; b < bodies.size(); ++b)
    if ((filter[b].fixed || filter.in_compound(b)) && bodies[b].body().solid() &&
        !bodies[b].body().rounded()) {
      fixed_.push_back(b);
      boxes_.push_back(bodies[b].tight_box());
    }
  double max_gap = 0;
  for (const std::uint32_t b : fixed_)
    max_gap = std::max(max_gap, kBeyond * bodies[b].pose().scale * diagonal_of(bodies[b]));
  for (const auto& [i, j] : sweep_.near_pairs(boxes_, max_gap)) {
    const std::uint32_t a = fixed_[i], b = fixed_[j];
    if (!filter.same_body(a, b) && !(filter[a].fixed && filter[b].fixed)) continue;
    neighbours_.push_back({a, b});
    neighbours_.push_back({b, a});
  }
  std::ranges::sort(neighbours_);
}

std::span<const Sweep::Pair> InternalContacts::neighbours(std::uint32_t body) const {
  const auto range =
      std::ranges::equal_range(neighbours_, body, {}, [](const Sweep::Pair& p) { return p[0]; });
  return {range.begin(), range.end()};
}

std::optional<InternalContacts::Exit> InternalContacts::exit_by(const Contact& contact,
                                                                const shape::PosedBody& body, int side,
                                                                Around& around) const {
  if (body.body().rounded()) return {};
  const sites::SitesData& sites = internals(body.body().sites());
  const auto& [face, weights] = contact.on[side];
  if (face == kNone || sites.sliver[face]) return {};
  find_faces(sites, contact.on[side], around);
  Exit exit{.direction = inverse(body.pose().map).linear(side == 0 ? -contact.normal : contact.normal)};
  exit.direction = normalized(exit.direction);
  for (int i = 0; i < 3; ++i) exit.point += weights[i] * sites.mesh.positions[sites.mesh.triangles[face][i]];
  return exit;
}

bool InternalContacts::contains(const Contact& contact, const Sweep::Pair& pair, Around& around) const {
  for (int side = 0; side < 2; ++side) {
    const shape::PosedBody& body = bodies_[pair[side]];
    const std::optional<Exit> exit = exit_by(contact, body, side, around);
    if (!exit) continue;
    if ((around.flat && off_flat_faces(body, *exit, around)) || into_neighbour(pair[side], *exit, around))
      return true;
  }
  return false;
}

bool InternalContacts::leads_into_neighbour(const Contact& contact, const Sweep::Pair& pair, int side,
                                            Around& around) const {
  if (neighbours(pair[side]).empty()) return false;
  const std::optional<Exit> exit = exit_by(contact, bodies_[pair[side]], side, around);
  return exit && into_neighbour(pair[side], *exit, around);
}

void InternalContacts::leave_out(std::vector<PairContacts>& pairs) {
  std::size_t count = 0;
  for (const PairContacts& pair : pairs) count += pair.contacts.size();
  external_.clear();
  external_.reserve(count);  // so that spans of it stay valid
  for (PairContacts& pair : pairs) {
    const std::size_t first = external_.size();
    for (const Contact& contact : pair.contacts)
      if (contact.id == ProximityQuery::kExitContact ||
          !contains(contact, {pair.first, pair.second}, around_))
        external_.push_back(contact);
    pair.contacts = std::span(external_).subspan(first);
  }
  std::erase_if(pairs, [](const PairContacts& pair) { return pair.contacts.empty(); });
}

// Whether a direction is none of those between the normals of the faces around a point, which are flat or
// concave there.
bool InternalContacts::off_flat_faces(const shape::PosedBody& body, const Exit& exit, const Around& around) {
  const sites::SitesData& sites = internals(body.body().sites());
  const Array<Vec3>& normals = sites.normals.face;
  double along = -1, spread = 1;
  for (const std::uint32_t face : around.faces) {
    const double cosine = dot(normals[face], exit.direction);
    along = std::max(along, sites.is_solid() ? cosine : std::abs(cosine));
    spread = std::min(spread, dot(normals[face], normals[around.faces[0]]));
  }
  return along < std::min(kAlong, spread - kFlat);
}

// Whether a neighbour covers the faces that the direction leaves by.
bool InternalContacts::into_neighbour(std::uint32_t body, const Exit& exit, const Around& around) const {
  if (neighbours(body).empty()) return false;
  const sites::SitesData& sites = internals(bodies_[body].body().sites());
  bool any = false;
  for (const std::uint32_t face : around.faces) {
    if (sites.sliver[face]) continue;
    const bool is_covered = covered(body, face, exit.point);
    if (!is_covered && dot(sites.normals.face[face], exit.direction) >= kAlong) return false;
    any |= is_covered;
  }
  return any;
}

// Whether a neighbour is beyond the face, beside the point: at the point itself, it may touch an edge
// alone.
bool InternalContacts::covered(std::uint32_t body, std::uint32_t face, const Vec3& point) const {
  const shape::PosedBody& posed = bodies_[body];
  const sites::SitesData& sites = internals(posed.body().sites());
  const Triangle& corners = sites.mesh.triangles[face];
  Vec3 middle{};
  for (const std::uint32_t corner : corners) middle += (1.0 / 3) * sites.mesh.positions[corner];
  const double beyond = kBeyond * diagonal_of(posed), away = norm(middle - point);
  const Vec3 beside = point + std::min(4 * beyond, 0.5 * away) * normalized(middle - point);
  const Vec3 probe = posed.pose().map(beside + beyond * sites.normals.face[face]);
  return std::ranges::any_of(neighbours(body), [&](const Sweep::Pair& pair) {
    const shape::PosedBody& other = bodies_[pair[1]];
    const Vec3 there = inverse(other.pose().map)(probe);
    if (!sdm::contains(other.body().box(), there)) return false;
    constexpr double kAnywhere = kInfinity;
    const ClosestPoint closest = closest::closest_point(internals(other.body().sites()), there, kAnywhere);
    return other.body().inside()(there, closest);
  });
}

std::span<const Contact> ExternalContacts::of(std::span<const shape::PosedBody> bodies,
                                              std::span<const Contact> all) {
  if (!known_) {
    internal_.follow(bodies, filter_);
    pair_.assign(1, {.first = 0, .second = 1, .contacts = all});
    internal_.leave_out(pair_);
    known_ = true;
  }
  return pair_.empty() ? std::span<const Contact>() : pair_.front().contacts;
}

}  // namespace sdm::bodies
