#include "inside/solid.h"

#include <algorithm>

#include "core/geometry/predicates.h"
#include "hierarchy/traverse.h"

namespace sdm::inside {
namespace {

// A box of the tree in the coordinates of the mesh, enlarged by much more than the rounding error of double
// precision.
Box posed(const hierarchy::FloatBox& box, const UnitFrame& frame, const Affine& pose) {
  constexpr double kRounding = 1e-13;
  Vec3 centre, half;
  for (int k = 0; k < 3; ++k) {
    centre[k] = frame.origin[k] + (0.5 * box.lo[k] + 0.5 * box.hi[k]) / frame.scale;
    half[k] = (0.5 * box.hi[k] - 0.5 * box.lo[k]) / frame.scale;
  }
  const Vec3 middle = pose(centre);
  Vec3 reach{};
  for (int i = 0; i < 3; ++i) {
    double magnitude = std::abs(pose.offset[i]);
    for (int j = 0; j < 3; ++j) {
      reach[i] += std::abs(pose.rows[i][j]) * half[j];
      magnitude += std::abs(pose.rows[i][j]) * (std::abs(frame.origin[j]) + 1 / frame.scale);
    }
    reach[i] += kRounding * magnitude;
  }
  return {middle - reach, middle + reach};
}

bool segment_meets(const Box& box, const Vec3& start, const Vec3& along) {
  constexpr double kRounding = 1e-12;
  double first = 0, last = 1;
  for (int k = 0; k < 3; ++k) {
    if (along[k] == 0) {
      if (start[k] < box.lo[k] || start[k] > box.hi[k]) return false;
      continue;
    }
    const auto [enter, leave] =
        std::minmax({(box.lo[k] - start[k]) / along[k], (box.hi[k] - start[k]) / along[k]});
    first = std::max(first, enter);
    last = std::min(last, leave);
  }
  return first <= last + kRounding;
}

// ±1 if the segment pq crosses the triangle, depending on the side that it comes from, otherwise 0; empty if
// it meets an edge of the triangle. Neither p nor q lies on the triangle.
std::optional<int> crossing(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const bool above_p = orientation(t[0], t[1], t[2], p) > 0, above_q = orientation(t[0], t[1], t[2], q) > 0;
  if (above_p == above_q) return 0;
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  const bool left = a > 0 || b > 0 || c > 0, right = a < 0 || b < 0 || c < 0;
  if (left && right) return 0;
  if (a * b * c == 0) return std::nullopt;
  return above_p ? 1 : -1;
}

}  // namespace

std::optional<int> winding(const sites::SitesData& sites, const Affine& pose, const Vec3& p, const Vec3& q) {
  std::optional<int> turns = 0;
  traverse(
      sites.tree, whole(sites.tree),
      [&](hierarchy::Subtree below) {
        return turns && segment_meets(posed(sites.tree.box(below.root), sites.frame, pose), p, q - p);
      },
      [&](std::uint32_t leaf) {
        for (const std::uint32_t face : sites.tree.items_of(leaf)) {
          const auto [a, b, c] = sites.mesh.triangles[face];
          const auto& at = sites.mesh.positions;
          const std::optional<int> sign = crossing(p, q, {pose(at[a]), pose(at[b]), pose(at[c])});
          if (!sign) return turns.reset();
          *turns += sites.inverted[face] ? -*sign : *sign;
        }
      });
  return turns;
}

bool contains(const sites::SitesData& solid, const Affine& pose, const Vec3& point) {
  const Box box = posed(solid.tree.box(0), solid.frame, pose);
  if (!sdm::contains(box, point)) return false;
  const double length = 2 * diagonal(box);
  // Segments along (1, t, t²) that intersect an edge are skipped. Those that meet the same edge lie in one
  // plane through the point, and no such plane contains more than two of them, so the loop terminates.
  for (double t = 0.0137035999;; t += 0.0072973525)
    if (const auto turns = winding(solid, pose, point, point + length * Vec3{1, t, t * t}))
      return *turns != 0;
}

}  // namespace sdm::inside
