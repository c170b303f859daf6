#include "certify/depth/boundary_distance.h"

#include <algorithm>

#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::depth {

using inside::Sides;

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

double bound_beyond_faces(const sites::SitesData& solid, const Corners& triangle, const shape::Ball& ball,
                          double most) {
  Box box;
  for (const Vec3& p : triangle) extend(box, solid.frame.to_unit(p));
  const tree::FloatBox around = tree::FloatBox::around(box);
  const double rounding = 1e-12 / solid.frame.scale;
  double bound = 0;
  const auto near = [&](tree::Subtree subtree) {
    return bound < most && squared_norm(gap(solid.tree.box(subtree.root), around)) == 0;
  };
  const auto add = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : solid.tree.items_of(leaf)) {
      const auto& [i, j, k] = solid.mesh.triangles[face];
      const Corners corners{solid.mesh.positions[i], solid.mesh.positions[j], solid.mesh.positions[k]};
      if (!triangles_intersect(triangle, corners)) continue;
      if (solid.sliver[face]) bound = most;
      const Vec3& n = solid.normals.face[face];
      const double height = dot(n, ball.centre - corners[0]), side = height < 0 ? -1 : 1;
      double beyond = 0;
      for (const Vec3& p : triangle) beyond = std::max(beyond, -side * dot(n, p - corners[0]));
      if (beyond > rounding)
        bound = std::max(bound, ball.radius * beyond / (beyond + side * height) + rounding);
    }
  };
  tree::visit(solid.tree, tree::InOrder{near, add});
  return std::min(most, bound);
}

}  // namespace sdm::depth
