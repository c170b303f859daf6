#include "bodies/shape/convexity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "closest/single_point.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "tree/visit.h"

namespace sdm::shape {
namespace {

constexpr double kNormalError = 4e-16;  // of a normal, relative to the ratio of sides to height

constexpr int kLanes = tree::WideTree::kWidth;

// How far vertices are above a plane; the policy of its search of the tree.
class VerticesAbove {
 public:
  explicit VerticesAbove(const sites::SitesData& sites) : sites_(sites) {}

  // A bound on the largest height above the plane through three corners, counter-clockwise from above: 0 if
  // there is none, exactly. Stops above `enough`.
  double height(const Corners& plane, double enough) {
    const Vec3 a = sites_.frame.to_unit(plane[0]), u = sites_.frame.to_unit(plane[1]) - a,
               v = sites_.frame.to_unit(plane[2]) - a;
    const double sides = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)});
    Vec3 normal = cross(u, v);
    // The normal of a needle, which is not reliable, excludes nothing.
    normal = kNormalError * sides < kSingleRounding * norm(normal) ? normalized(normal) : Vec3{};
    for (int k = 0; k < 3; ++k) normal_[k] = static_cast<float>(normal[k]);
    plane_ = plane;
    height_ = 0;
    enough_ = enough;
    least_ = static_cast<float>(dot(normal, a) - 4 * kSingleRounding);
    tree::visit(sites_.wide, open_, *this);
    return height_;
  }

  // The farthest first.
  static bool before(float first, float second) { return first >= second; }
  [[nodiscard]] bool enter(const tree::OpenNode& open) const {
    return height_ <= enough_ && (open.child == 0 || open.bound >= least_);
  }
  std::uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node, float (&most)[kLanes]) const {
    for (float& x : most) x = 0;
    for (int k = 0; k < 3; ++k) {
      const float* far = normal_[k] > 0 ? node.upper[k] : node.lower[k];
      for (int i = 0; i < kLanes; ++i) most[i] += normal_[k] * far[i];
    }
    return (1u << node.count) - 1;
  }
  void leaf(const tree::OpenNode& open) {
    const std::uint32_t leaf = open.leaf_number();
    for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
      for (const std::uint32_t vertex : sites_.mesh.triangles[sites_.regions.owners[i].face])
        if (const Vec3& p = sites_.mesh.positions[vertex];
            orientation(plane_[0], plane_[1], plane_[2], p) > 0)
          height_ = std::max(height_, bound_on_height(plane_, p));
  }

 private:
  // An upper bound on the height of a point above the plane.
  static double bound_on_height(const Corners& plane, const Vec3& p) {
    const Vec3 u = plane[1] - plane[0], v = plane[2] - plane[0], normal = cross(u, v), x = p - plane[0];
    const double area = norm(normal);
    if (!(area > 0)) return kInfinity;
    const double sides = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)});
    return std::abs(dot(normal, x)) / area + kNormalError * norm(x) * (1 + sides / area);
  }

  const sites::SitesData& sites_;
  Corners plane_{};
  float normal_[3] = {}, least_ = 0;
  double height_ = 0, enough_ = 0;
  std::vector<tree::OpenNode> open_;
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
  constexpr double kNot = kInfinity;
  if (!sites.is_solid()) return kNot;
  const Mesh& mesh = sites.mesh;
  const Box box = bounds(mesh);
  for (int k = 0; k < 3; ++k)
    if (!(box.lower[k] < box.upper[k])) return kNot;
  Vec3 middle{};
  double count = 0, deficit = 0;
  for (const std::uint32_t face : sites.tree.items)
    for (const std::uint32_t vertex : mesh.triangles[face]) {
      count += 1;
      middle += (1 / count) * (mesh.positions[vertex] - middle);
    }
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
  const ClosestPoint closest = closest::closest_point(sites, middle, kInfinity);
  return inside(middle, closest) ? deficit : kNot;
}

}  // namespace sdm::shape
