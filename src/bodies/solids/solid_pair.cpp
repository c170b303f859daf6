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

SolidPair::SolidPair(const shape::PosedBody& o1, const shape::PosedBody& o2, SolidWorkspace& workspace)
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

const Relation& SolidPair::relation() {
  if (!relation_)
    relation_ = half_space(0)   ? of_half_space(0)
                : half_space(1) ? of_half_space(1)
                : !convex(0)    ? of_mesh(0)
                : !convex(1)    ? of_mesh(1)
                                : of_convex();
  return *relation_;
}

const QuickDistance& SolidPair::quick() {
  if (!quick_) quick_ = quick_distance(cores_[0], cores_[1], size_);
  return *quick_;
}

bool SolidPair::colliding() {
  if (!relation_ && both_convex()) {
    if (quick().overlapping) return true;
    if (quick().known) return quick().distance - (cores_[0].radius() + cores_[1].radius()) <= 0;
  }
  return relation().colliding;
}

std::array<std::uint32_t, 2> SolidPair::faces() {
  const Relation& found = relation();
  std::array<std::uint32_t, 2> faces{kNone, kNone};
  for (const int body : {0, 1})
    faces[body] = convex(body) || half_space(1 - body)
                      ? face_at(*bodies_[body], body == 0 ? found.point1 : found.point2)
                      : nearest_face_;
  return faces;
}

const SurfaceDistance& SolidPair::surfaces() {
  if (!surfaces_) surfaces_ = between_surfaces();
  return *surfaces_;
}

SurfaceDistance SolidPair::between_surfaces() {
  for (const int body : {0, 1})
    if (half_space(body)) return beside_half_space(body);
  for (const int body : {0, 1})
    if (!convex(body)) return beside_mesh(body);
  if (colliding()) return of_nested();
  const Relation& found = relation();
  return {std::max(0.0, found.gap - found.error), found.gap, std::array{found.point1, found.point2}};
}

// The height of the lowest point of the other body is the signed distance.
Relation SolidPair::of_half_space(int half_space) {
  const PosedCore &space = cores_[half_space], &other = cores_[1 - half_space];
  const Vec3& n = space.normal();
  const Vec3 lowest = other.support(-n);
  Relation relation;
  relation.gap = dot(n, lowest) - space.offset() - other.radius();
  relation.normal = half_space == 1 ? n : -n;
  std::array<Vec3, 2> points;
  points[1 - half_space] = lowest - other.radius() * n;
  points[half_space] = points[1 - half_space] - relation.gap * n;
  relation.point1 = points[0];
  relation.point2 = points[1];
  relation.colliding = relation.gap <= 0;
  return relation;
}

SurfaceDistance SolidPair::beside_half_space(int half_space) const {
  const PosedCore &space = cores_[half_space], &other = cores_[1 - half_space];
  const Vec3& n = space.normal();
  const auto at = [&](const Vec3& p, double height) {
    std::array<Vec3, 2> points;
    points[1 - half_space] = p;
    points[half_space] = p - height * n;
    return SurfaceDistance{std::abs(height), std::abs(height), points};
  };
  const Vec3 lowest = other.support(-n) - other.radius() * n;
  if (const double bottom = dot(n, lowest) - space.offset(); bottom > 0) return at(lowest, bottom);
  const Vec3 highest = other.support(n) + other.radius() * n;
  if (const double top = dot(n, highest) - space.offset(); top < 0) return at(highest, top);
  return {};
}

Relation SolidPair::of_convex() {
  const CoreDistance cores = core_distance(cores_[0], cores_[1], size_, quick(), workspace_.exit);
  const double radius1 = cores_[0].radius(), radius2 = cores_[1].radius();
  Relation relation;
  relation.gap = cores.distance - (radius1 + radius2);
  relation.error = cores.error;
  relation.normal = cores.normal;
  relation.point1 = cores.point1 - radius1 * cores.normal;
  relation.point2 = cores.point2 + radius2 * cores.normal;
  relation.colliding = relation.gap <= 0;
  return relation;
}

// The signed distance of a point from a core.
double SolidPair::distance_to(int body, const Vec3& p) {
  const PosedCore& core = cores_[body];
  if (core.kind() == CoreKind::axis) return point_to_axis(p, core).distance;
  // Inside of all planes, it is that of the nearest one.
  if (const convex::ConvexMesh* mesh = core.convex()) {
    const shape::PosedBody& posed = core.body();
    const Vec3 local = inverse(posed.pose().map)(p);
    const Mesh& faces = internals(posed.body().sites()).mesh;
    double highest = -kInfinity;
    for (std::size_t face = 0; face < mesh->normals.size() && highest <= 0; ++face)
      highest =
          std::max(highest, dot(mesh->normals[face], local - faces.positions[faces.triangles[face][0]]));
    if (highest <= 0) return posed.pose().scale * highest;
  }
  return core_distance(PosedCore(p), core, size_, workspace_.exit).distance;
}

// Whether the core of a body with one radius certainly has a point outside of the other core with another
// one.
bool SolidPair::extends_beyond(int body, double radius, int from, double from_radius) const {
  const PosedCore &core = cores_[body], &other = cores_[from];
  const Vec3 between = core.centre() - other.centre();
  constexpr double kRounding = 1e-12;  // of the size
  const auto beyond = [&](const Vec3& u) {
    return dot(u, core.support(u) - other.support(u)) + radius - from_radius > kRounding * size_;
  };
  if (between != Vec3{} && beyond(normalized(between))) return true;
  for (const Vec3& axis : {core.axis(), other.axis(), unit_across(other.axis())})
    if (beyond(axis) || beyond(-axis)) return true;
  return false;
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
SurfaceDistance SolidPair::of_nested() {
  for (const int inner : {0, 1}) {
    const double radius = cores_[1 - inner].radius();
    if (extends_beyond(inner, cores_[inner].radius(), 1 - inner, radius)) continue;
    const auto [least, most] = farthest_of(inner, 1 - inner);
    if (least <= radius) return {std::max(0.0, radius - most), radius - least, {}};
  }
  return {};
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
  nearest_face_ = nearest.face;
  std::array<Vec3, 2> points;
  points[mesh] = nearest.point1;
  points[1 - mesh] = nearest.point2 + (inside ? -radius : radius) * nearest.normal;
  relation.point1 = points[0];
  relation.point2 = points[1];
  relation.normal = ((mesh == 0) == inside ? -1 : 1) * nearest.normal;
  return relation;
}

SurfaceDistance SolidPair::beside_mesh(int mesh) {
  const Relation& found = relation();
  const double radius = cores_[1 - mesh].radius();
  const bool inside = found.gap < -radius;  // the core
  const double d = inside ? -found.gap - radius : found.gap + radius;
  if (!(d >= radius && d > 0)) {
    const double between = between_parts(mesh);
    return {between, between, {}};
  }
  std::array points{found.point1, found.point2};
  if (inside) points[1 - mesh] += (mesh == 0 ? -2 * radius : 2 * radius) * found.normal;
  return {std::max(0.0, d - found.error - radius), d - radius, points};
}

// The distance of the surface of a mesh, of which a point is in the other body, from that of the other body.
// A connected part of it is inside, or outside, as a whole, or has a point on the surface.
double SolidPair::between_parts(int mesh) {
  const shape::PosedBody& body = *bodies_[mesh];
  const sites::SitesData& sites = internals(body.body().sites());
  const std::span<const std::uint32_t> part_of = sites.orientation.component;
  const double radius = cores_[1 - mesh].radius();
  std::vector<double>& farthest = workspace_.farthest;
  farthest.assign(sites.orientation.first_face.size(), -kInfinity);
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
  faces_within(body, cores_[1 - mesh], radius + least, workspace_.near);
  for (const FaceDistance& face : workspace_.near) {
    if (part_of[face.face] == kNone || farthest[part_of[face.face]] <= radius) continue;
    least = std::max(0.0, std::min(least, face.distance - radius));
  }
  return least;
}

BoundedLength SolidPair::depth() {
  const Relation& relation = this->relation();
  for (const int body : {0, 1})
    if (!relation.signed_distance && !convex(body)) return depth_of_mesh(body);
  const double exit = -relation.gap;
  // Below a half-space, the lowest point is the deepest; no point of the plane is deeper in the other body.
  BoundedNumber depth{.lower = exit, .upper = exit};
  if (!bodies_[0]->body().half_space() && !bodies_[1]->body().half_space()) {
    const BoundedNumber first = depth_into(0), second = depth_into(1);
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
BoundedNumber SolidPair::depth_into(int outer) {
  const PosedCore &core = cores_[outer], &other = cores_[1 - outer];
  const Relation& relation = this->relation();
  const double exit = -relation.gap;
  const double between = relation.gap + core.radius() + other.radius();
  if (between >= other.radius() && between > 0) return {.lower = exit, .upper = exit + relation.error};
  if (!extends_beyond(outer, 0, 1 - outer, other.radius())) {
    const auto [least, most] = farthest_of(outer, 1 - outer);
    const double beyond = other.radius() + core.radius();  // farthest_of() has the radius of this body, too
    if (most <= beyond)
      return {.lower = core.radius() - (beyond - least), .upper = core.radius() - (beyond - most)};
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
BoundedLength SolidPair::depth_of_mesh(int mesh) {
  const Relation& relation = this->relation();
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
