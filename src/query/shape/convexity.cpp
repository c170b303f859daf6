#include "query/shape/convexity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "query/closest/closest_points.h"

namespace sdm::shape {
namespace {

constexpr double kNormalError = 4e-16;  // of a normal, relative to the ratio of sides to height

// How far vertices are above the plane through three corners, counter-clockwise from above.
class VerticesAbove {
 public:
  explicit VerticesAbove(const sites::SitesData& sites) : sites_(sites) {}

  // A bound on the largest height, 0 if there is none, exactly; stops above `enough`.
  double height(const Corners& plane, double enough) {
    const UnitFrame& frame = sites_.frame;
    const Vec3 a = frame.to_unit(plane[0]);
    double height = 0;
    const Vec3 normal = normalized(cross(frame.to_unit(plane[1]) - a, frame.to_unit(plane[2]) - a));
    open_.assign(1, 0);
    while (!open_.empty()) {
      const std::uint32_t node = open_.back();
      open_.pop_back();
      const tree::AabbTree::Node& n = sites_.tree.nodes[node];
      // A normal that is too short to be computed excludes nothing.
      double most = normal == Vec3{} ? 1 : kSingleRounding - dot(normal, a);
      for (int k = 0; k < 3; ++k) most += normal[k] * (normal[k] > 0 ? n.box.hi[k] : n.box.lo[k]);
      if (most < 0) continue;
      if (!n.leaf()) {
        open_.push_back(n.right);
        open_.push_back(node + 1);
        continue;
      }
      for (const std::uint32_t face : sites_.tree.items_of(node))
        for (const std::uint32_t vertex : sites_.mesh.triangles[face])
          if (const Vec3& p = sites_.mesh.positions[vertex]; orientation(plane[0], plane[1], plane[2], p) > 0)
            height = std::max(height, bound(plane, p));
      if (height > enough) break;
    }
    return height;
  }

 private:
  // On the height of a point above the plane.
  static double bound(const Corners& plane, const Vec3& p) {
    const Vec3 u = plane[1] - plane[0], v = plane[2] - plane[0], normal = cross(u, v), x = p - plane[0];
    const double area = norm(normal);
    if (!(area > 0)) return std::numeric_limits<double>::infinity();
    const double sides = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)});
    return std::abs(dot(normal, x)) / area + kNormalError * norm(x) * (1 + sides / area);
  }

  const sites::SitesData& sites_;
  std::vector<std::uint32_t> open_;  // nodes
};

// Whether the corners are on one line: exactly, as one of four points that are in no plane is beside any
// plane through the line.
bool without_area(const Corners& corners, const Box& box) {
  const auto& [lo, hi] = box;
  const std::array<Vec3, 4> others{lo, {hi[0], lo[1], lo[2]}, {lo[0], hi[1], lo[2]}, {lo[0], lo[1], hi[2]}};
  return std::ranges::all_of(
      others, [&](const Vec3& p) { return orientation(corners[0], corners[1], corners[2], p) == 0; });
}

}  // namespace

double convexity_deficit(const sites::SitesData& sites, const inside::InsideTest& inside) {
  constexpr double kNot = std::numeric_limits<double>::infinity();
  if (!sites.is_solid()) return kNot;
  const Mesh& mesh = sites.mesh;
  const Box box = bounds(mesh);
  for (int k = 0; k < 3; ++k)
    if (!(box.lo[k] < box.hi[k])) return kNot;
  Vec3 middle{};
  double count = 0, deficit = 0;
  for (const std::uint32_t face : sites.tree.items)
    for (const std::uint32_t vertex : mesh.triangles[face])
      count += 1, middle += (1 / count) * (mesh.positions[vertex] - middle);
  VerticesAbove above(sites);
  for (const std::uint32_t face : sites.tree.items) {
    const auto& [a, b, c] = mesh.triangles[face];
    Corners corners{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
    const int side = orientation(corners[0], corners[1], corners[2], middle);
    if (side == 0 && without_area(corners, box)) continue;
    if (side == 0) return kNot;
    if (side > 0) std::swap(corners[0], corners[1]);
    const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    const double below = dot(normal, corners[0] - middle);
    const double height = above.height(corners, kNearlyConvex * below);
    if (height == 0) continue;
    if (!(height <= kNearlyConvex * below)) return kNot;
    deficit = std::max(deficit, height / below);
  }
  const ClosestPoint closest = closest::closest_point(sites, middle, std::numeric_limits<double>::infinity());
  return inside(middle, closest) ? deficit : kNot;
}

}  // namespace sdm::shape
