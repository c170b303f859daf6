#include "certify/depth/boundary.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/depth/face_distances.h"
#include "geometry/point_triangle.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::depth {

using inside::Sides;

std::array<CornerValues, 2> corner_distances(const sites::SitesData& solid, const Corners& at,
                                             const std::array<BoundaryPart, 2>& boundary) {
  std::array<std::uint32_t, 2> faces{boundary[0].face, boundary[1].face};
  std::array<CornerValues, 2> result;
  if (faces[0] != kNone || faces[1] != kNone) {
    for (int n = 0; n < 2; ++n)
      if (faces[n] == kNone) faces[n] = faces[1 - n];
    const auto found = face_distances(solid, {at[0], at[1], at[2], at[0]}, faces);
    for (int n = 0; n < 2; ++n) result[n] = {found[n][0], found[n][1], found[n][2]};
  }
  for (int n = 0; n < 2; ++n)
    if (boundary[n].face == kNone)
      for (int k = 0; k < 3; ++k) result[n][k] = norm(at[k] - boundary[n].point) - boundary[n].clear;
  return result;
}

bool heights_below_plane(const sites::SitesData& solid, const Corners& at, const BoundaryPart& boundary,
                         CornerValues& heights) {
  constexpr double kThinnest = 1e4;      // its error is 1e-10 of a distance
  constexpr double kLeastArea = 1e-150;  // squares of others underflow
  if (boundary.face == kNone || boundary.clear > 0) return false;
  const auto [a, b, c] = corners_of(solid.mesh, boundary.face);
  const Vec3 u = b - a, v = c - a, across = cross(u, v);
  const double area = norm(across);
  const double ratio = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)}) / area;
  if (!(ratio < kThinnest && area > kLeastArea)) return false;
  const Vec3 inward = (solid.inverted[boundary.face] != 0 ? 1 : -1) / area * across;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 x = at[k] - a;
    heights[k] = dot(inward, x) + kProductRounding * ratio * norm(x);
  }
  return true;
}

std::optional<BoundaryPart> boundary_face(const shape::Body& solid, const ClosestPoint& closest) {
  const Sides sides = solid.inside().sides().of_site(closest.type, closest.site);
  if (sides != Sides::boundary && sides != Sides::reversed) return {};
  return BoundaryPart{.face = internals(solid.sites()).face_of(closest.type, closest.site),
                      .point = closest.point};
}

BoundaryDistance distance_to_boundary(const shape::Body& solid, const Vec3& p) {
  solid.require_boundary();
  const inside::SolidBoundary::Closest b = solid.boundary().closest(p);
  BoundaryDistance result{
      .lower = b.lower, .upper = b.upper, .value = b.point ? b.upper : b.lower, .point = b.point};
  if (b.point) result.nearest = {.point = *b.point};
  return result;
}

BoundaryDistance boundary_distance(const shape::Body& solid, const Vec3& p, const ClosestPoint& closest) {
  const double distance = closest.distance;
  BoundaryDistance result{distance, distance, distance, closest.point, boundary_face(solid, closest)};
  if (result.nearest) return result;
  if (solid.inside().at_boundary(p, closest)) {
    result.nearest = {.point = closest.point};
    return result;
  }
  return distance_to_boundary(solid, p);
}

double bound_beyond_faces(const shape::Body& solid, const Corners& triangle, const shape::Ball& ball,
                          double distance, double most) {
  const sites::SitesData& sites = internals(solid.sites());
  const double rounding = 1e-12 / sites.frame.scale;
  const double same = kUnitDistanceRounding / sites.frame.scale;
  const bool touching = distance <= same;
  Box box;
  for (const Vec3& p : triangle) extend(box, sites.frame.to_unit(p));
  const tree::FloatBox around = tree::FloatBox::around(box);
  double bound = 0;
  const auto near = [&](tree::Subtree subtree) {
    return bound < most && squared_norm(gap(sites.tree.box(subtree.root), around)) == 0;
  };
  const auto add = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const Corners corners = corners_of(sites.mesh, face);
      if (!triangles_intersect(triangle, corners)) continue;
      const bool flat = sites.sliver[face] == 0;
      if (!flat) bound = most;
      const Vec3& n = sites.normals.face[face];
      double above = 0, below = 0;
      for (const Vec3& p : triangle) {
        const double height = dot(n, p - corners[0]);
        above = std::max(above, height);
        below = std::max(below, -height);
      }
      double height = dot(n, ball.centre - corners[0]);
      double beyond = height < 0 ? above : below;
      if (std::abs(height) <= same ||
          (touching && closest_feature(ball.centre, corners, flat).squared <= same * same)) {
        const Sides sides = solid.inside().sides().of_face(face);
        beyond = sides == Sides::boundary ? below : sides == Sides::reversed ? above : std::max(above, below);
        height = 0;
      }
      if (beyond > rounding)
        bound = std::max(bound, ball.radius * beyond / (beyond + std::abs(height)) + rounding);
    }
  };
  tree::visit(sites.tree, tree::InOrder{near, add});
  return std::min(most, bound);
}

namespace {

// A triangle is bounded by two of so many parts of the boundary that were found last.
constexpr std::size_t kRecent = 32;

}  // namespace

std::optional<std::array<BoundaryPart, 2>> KnownBoundary::nearest(const Vec3& centre,
                                                                  std::span<const CornerBound> besides,
                                                                  std::size_t seen) const {
  const std::size_t none = known_.size();
  std::array<std::size_t, 2> nearest{none, none};
  std::array<double, 2> squared;
  squared.fill(kInfinity);
  for (std::size_t i = none - std::min(none, kRecent); i < none; ++i) {
    const double s = squared_norm(known_[i].from - centre);
    const std::uint32_t face = known_[i].boundary.face;
    if (!(s < squared[1]) || (face != kNone && std::ranges::any_of(besides, [&](const CornerBound& n) {
                                return n.boundary.face == face;
                              })))
      continue;
    squared[1] = s;
    nearest[1] = i;
    if (s < squared[0]) {
      std::swap(squared[0], squared[1]);
      std::swap(nearest[0], nearest[1]);
    }
  }
  const auto is_new = [&](std::size_t i) { return i < none && i >= seen; };
  if (!is_new(nearest[0]) && !is_new(nearest[1])) return {};
  if (nearest[1] == none) nearest[1] = nearest[0];
  return std::array{known_[nearest[0]].boundary, known_[nearest[1]].boundary};
}

}  // namespace sdm::depth
