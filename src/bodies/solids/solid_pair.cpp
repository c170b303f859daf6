#include "bodies/solids/solid_pair.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bodies/solids/core_distance.h"
#include "bodies/solids/mesh_distance.h"
#include "closest/single_point.h"
#include "geometry/unit_across.h"
#include "geometry/vec.h"
#include "inside/inside.h"
#include "inside/solid.h"

namespace sdm::solids {
namespace {

constexpr double kInHull = 0;
constexpr double kExactGap = 1e-7;  // of the size: bounds so close are one number
constexpr int kRimPoints = 256;

// Calls visit(point, factor) for points whose convex hull contains the core if they are moved away from its
// axis by the factor, and is in it if they are not.
template <class Visit>
void for_extreme_points(const PosedCore& core, const Visit& visit) {
  if (core.convex() != nullptr) {
    for (const Vec3& p : core.convex()->points) visit(core.body().pose().map(p), kInHull);
    return;
  }
  const Vec3 x = unit_across(core.axis());
  const Vec3 y = cross(core.axis(), x);
  const double beyond = core.disc() * (1 / std::cos(std::numbers::pi / kRimPoints) - 1);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 middle = core.centre() + side * core.half();
    if (core.disc() == 0) {
      visit(middle, kInHull);
      continue;
    }
    for (int i = 0; i < kRimPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kRimPoints;
      visit(middle + core.disc() * (std::cos(angle) * x + std::sin(angle) * y), beyond);
    }
  }
}

std::uint32_t face_at(const shape::PosedBody& body, const Vec3& p) {
  if (!body.body().has_mesh()) return kNone;
  const sites::SitesData& sites = internals(body.body().sites());
  const ClosestPoint closest = closest::closest_point(sites, inverse(body.pose().map)(p), kInfinity);
  return closest.type == SiteType::none ? kNone : sites.face_of(closest.type, closest.site);
}

BoundedLength bounded(double lower, double upper, double size) {
  BoundedLength result;
  result.lower = result.value = std::max(0.0, lower);
  result.upper = std::max(result.lower, upper);
  result.certainty = result.upper - result.lower <= kExactGap * size ? Certainty::exact : Certainty::bounded;
  return result;
}

}  // namespace

SolidPair::SolidPair(const shape::PosedBody& o1, const shape::PosedBody& o2, convex::ExitWorkspace& workspace)
    : bodies_{&o1, &o2}, cores_{PosedCore(o1), PosedCore(o2)}, workspace_(workspace) {
  if (o1.body().half_space() && o2.body().half_space())
    throw Error(
        "two half-spaces are no pair of bodies: they overlap without end, or are parallel; leave one out");
  if (o1.body().half_space() || o2.body().half_space()) {
    size_ = diagonal(bodies_[o1.body().half_space() ? 1 : 0]->box());
  } else {
    Box box = o1.box();
    extend(box, o2.box());
    size_ = diagonal(box);
  }
}

Relation SolidPair::relation() {
  for (const int body : {0, 1})
    if (bodies_[body]->body().half_space()) return of_half_space(body);
  for (const int body : {0, 1})
    if (!convex(body)) return of_mesh(body);
  return of_convex();
}

// The height of the lowest point of the other body is the signed distance.
Relation SolidPair::of_half_space(int half_space) {
  const PosedCore &space = cores_[half_space], &other = cores_[1 - half_space];
  const Vec3& n = space.normal();
  const Vec3 lowest = other.support(-n), highest = other.support(n);
  Relation relation;
  relation.gap = dot(n, lowest) - space.offset() - other.radius();
  relation.normal = half_space == 1 ? n : -n;
  std::array<Vec3, 2> points;
  points[1 - half_space] = lowest - other.radius() * n;
  points[half_space] = points[1 - half_space] - relation.gap * n;
  relation.point1 = points[0];
  relation.point2 = points[1];
  relation.colliding = relation.gap <= 0;
  relation.faces[1 - half_space] = face_at(*bodies_[1 - half_space], lowest);
  const double top = dot(n, highest) - space.offset() + other.radius();
  double surfaces = 0;
  if (relation.gap > 0) {
    surfaces = relation.gap;
    relation.closest = points;
  } else if (top < 0) {
    surfaces = -top;
    points[1 - half_space] = highest + other.radius() * n;
    points[half_space] = points[1 - half_space] - top * n;
    relation.closest = points;
  }
  relation.surface_lower = relation.surface_upper = surfaces;
  return relation;
}

Relation SolidPair::of_convex() {
  const CoreDistance cores = core_distance(cores_[0], cores_[1], size_, workspace_);
  const double radius1 = cores_[0].radius(), radius2 = cores_[1].radius();
  Relation relation;
  relation.gap = cores.distance - (radius1 + radius2);
  relation.error = cores.error;
  relation.normal = cores.normal;
  relation.point1 = cores.point1 - radius1 * cores.normal;
  relation.point2 = cores.point2 + radius2 * cores.normal;
  relation.colliding = relation.gap <= 0;
  relation.faces = {face_at(*bodies_[0], relation.point1), face_at(*bodies_[1], relation.point2)};
  if (!relation.colliding) {
    relation.surface_lower = std::max(0.0, relation.gap - relation.error);
    relation.surface_upper = relation.gap;
    relation.closest = {relation.point1, relation.point2};
  } else {
    find_nesting(relation);
  }
  return relation;
}

// The signed distance of a point from a core.
double SolidPair::distance_to(int body, const Vec3& p) {
  const PosedCore& core = cores_[body];
  if (core.kind() == CoreKind::axis) return point_to_axis(p, core).distance;
  return core_distance(PosedCore(p), core, size_, workspace_).distance;
}

// Bounds on the largest distance of a point of a convex body from the core of the other one: that of a vertex
// of its core, as the distance is convex, and its radius.
std::array<double, 2> SolidPair::farthest_of(int body, int from) {
  double least = -kInfinity, most = -kInfinity;
  for_extreme_points(cores_[body], [&](const Vec3& p, double beyond) {
    const double distance = distance_to(from, p);
    least = std::max(least, distance);
    most = std::max(most, distance + beyond);
  });
  return {least + cores_[body].radius(), most + cores_[body].radius()};
}

// Surfaces of two convex bodies that overlap have a point in common unless one body contains the other.
void SolidPair::find_nesting(Relation& relation) {
  for (const int inner : {0, 1}) {
    const auto [least, most] = farthest_of(inner, 1 - inner);
    const double radius = cores_[1 - inner].radius();
    if (least > radius) continue;
    relation.surface_lower = std::max(0.0, radius - most);
    relation.surface_upper = radius - least;
    return;
  }
}

Relation SolidPair::of_mesh(int mesh) {
  const PosedCore& core = cores_[1 - mesh];
  const shape::PosedBody& body = *bodies_[mesh];
  const sites::SitesData& sites = internals(body.body().sites());
  const FaceDistance nearest = nearest_face(body, core);
  const double radius = core.radius(), d = nearest.distance;
  const bool inside = d > 0 && sites.is_solid() && inside::contains(sites, body.pose().map, nearest.point2);
  Relation relation;
  relation.signed_distance = false;
  relation.error = nearest.error;
  relation.gap = (inside ? -d : d) - radius;
  relation.colliding = inside || d <= radius;
  relation.faces[mesh] = nearest.face;
  std::array<Vec3, 2> points;
  points[mesh] = nearest.point1;
  points[1 - mesh] = nearest.point2 + (inside ? -radius : radius) * nearest.normal;
  relation.point1 = points[0];
  relation.point2 = points[1];
  relation.normal = ((mesh == 0) == inside ? -1 : 1) * nearest.normal;
  if (d >= radius && d > 0) {
    relation.surface_lower = std::max(0.0, d - nearest.error - radius);
    relation.surface_upper = d - radius;
    points[1 - mesh] = nearest.point2 + radius * nearest.normal;
    relation.closest = points;
  } else {
    relation.surface_lower = relation.surface_upper = between_parts(mesh);
  }
  return relation;
}

// The distance of the surface of a mesh, of which a point is in the other body, from that of the other body.
// A connected part of it is inside, or outside, as a whole, or has a point on the surface.
double SolidPair::between_parts(int mesh) {
  const shape::PosedBody& body = *bodies_[mesh];
  const sites::SitesData& sites = internals(body.body().sites());
  const std::span<const std::uint32_t> part_of = sites.orientation.component;
  const double radius = cores_[1 - mesh].radius();
  std::vector<double> farthest(sites.orientation.first_face.size(), -kInfinity);
  for (std::size_t face = 0; face < part_of.size(); ++face) {
    if (part_of[face] == kNone) continue;
    double& most = farthest[part_of[face]];
    for (const std::uint32_t vertex : sites.mesh.triangles[face])
      most = std::max(most, distance_to(1 - mesh, body.pose().map(sites.mesh.positions[vertex])));
  }
  double least = kInfinity;
  for (const double most : farthest)
    if (most <= radius) least = std::min(least, radius - most);
  if (least == kInfinity) return 0;
  std::vector<FaceDistance> near;
  faces_within(body, cores_[1 - mesh], radius + least, near);
  for (const FaceDistance& face : near) {
    if (part_of[face.face] == kNone || farthest[part_of[face.face]] <= radius) continue;
    least = std::max(0.0, std::min(least, face.distance - radius));
  }
  return least;
}

BoundedLength SolidPair::depth(const Relation& relation) {
  for (const int body : {0, 1})
    if (!relation.signed_distance && !convex(body)) return depth_of_mesh(body, relation);
  const double exit = -relation.gap;
  // Below a half-space, the lowest point is the deepest; no point of the plane is deeper in the other body.
  BoundedNumber depth{.lower = exit, .upper = exit};
  if (!bodies_[0]->body().half_space() && !bodies_[1]->body().half_space()) {
    const BoundedNumber first = depth_into(0, relation), second = depth_into(1, relation);
    depth.lower = std::max(first.lower, second.lower);
    depth.upper = std::max(first.upper, second.upper);
  }
  BoundedLength result = bounded(depth.lower, depth.upper, size_);
  if (std::abs(result.value - exit) <= kExactGap * size_) result.witness = {relation.point1, relation.point2};
  return result;
}

// The depth of the surface S of the other body, A, in this one, with the core K and the radius r. If K is not
// in A, or is in it as a whole, it is r − dist(S, K). Otherwise S divides K: the depth is r if K has no
// inside.
BoundedNumber SolidPair::depth_into(int outer, const Relation& relation) {
  const PosedCore &core = cores_[outer], &other = cores_[1 - outer];
  const double exit = -relation.gap;
  const double between = core_distance(core, other, size_, workspace_).distance;
  if (between >= other.radius() && between > 0) return {.lower = exit, .upper = exit + relation.error};
  const auto [least, most] = farthest_of(outer, 1 - outer);
  const double beyond = other.radius() + core.radius();  // farthest_of() has the radius of this body, too
  if (least < beyond) {
    const double lower = core.radius() - (beyond - least), upper = core.radius() - (beyond - most);
    if (most <= beyond) return {.lower = lower, .upper = upper};
  }
  if (core.thin()) return {.lower = core.radius(), .upper = core.radius()};
  // A point of S along the exit, and others; no point is deeper than the exit.
  double deepest = 0;
  const auto try_point = [&](const Vec3& p) {
    deepest = std::max(deepest, core.radius() - distance_to(outer, p));
  };
  try_point(outer == 1 ? relation.point1 : relation.point2);
  const Vec3 towards = core.centre() - other.centre();
  for (const Vec3& u : {towards, relation.normal, -relation.normal})
    if (u != Vec3{}) try_point(other.support(normalized(u)) + other.radius() * normalized(u));
  return {.lower = std::min(deepest, exit), .upper = exit + relation.error};
}

// Let A be a mesh, and K the core of the other body, without an inside, at the distance d of the surface of
// A. The surface of A is r − d deep in the other body. A way from a point of the other surface to the nearest
// one of K is r long. If K is outside A, at least d of it are, too: the point is no deeper in A than r − d.
// Otherwise it is no deeper than r and the depth of a point of K.
BoundedLength SolidPair::depth_of_mesh(int mesh, const Relation& relation) {
  const PosedCore& core = cores_[1 - mesh];
  const shape::PosedBody& body = *bodies_[mesh];
  const sites::SitesData& sites = internals(body.body().sites());
  const double radius = core.radius();
  const bool outside = relation.normal != Vec3{} && relation.gap > -radius;
  if (outside || (core.thin() && !sites.is_solid())) {
    const double d = outside                     ? relation.gap + radius
                     : relation.normal == Vec3{} ? 0
                                                 : std::abs(relation.gap + radius);
    BoundedLength result = bounded(radius - d, radius - d + relation.error, size_);
    if (outside) result.witness = {relation.point1, relation.point2};
    return result;
  }
  const Affine to_mesh = inverse(body.pose().map);
  const auto depth_at = [&](const Vec3& p) {
    const Vec3 q = to_mesh(p);
    const ClosestPoint closest = closest::closest_point(sites, q, kInfinity);
    return body.body().inside()(q, closest) ? body.pose().scale * closest.distance : 0.0;
  };
  // Points of the mesh in the other body, and of the other surface in the mesh.
  double lower = core.thin() ? radius - (relation.normal == Vec3{} ? 0 : -relation.gap - radius) : 0;
  if (!core.thin())
    for (const Vec3& p : sites.mesh.positions)
      lower = std::max(lower, radius - distance_to(1 - mesh, body.pose().map(p)));
  constexpr int kDirections = 3;
  for (int x = 0; x < kDirections; ++x)
    for (int y = 0; y < kDirections; ++y)
      for (int z = 0; z < kDirections; ++z) {
        const Vec3 u{x - 1.0, y - 1.0, z - 1.0};
        if (u != Vec3{})
          lower = std::max(lower, depth_at(core.support(normalized(u)) + radius * normalized(u)));
      }
  // No point of the core is farther from its middle than this.
  double reach = norm(core.half()) + core.disc();
  if (core.convex() != nullptr) reach = core.body().ball().radius - radius;
  const double upper = depth_at(core.centre()) + reach + radius;
  return bounded(lower, upper, size_);
}

}  // namespace sdm::solids
