#include "query/inside/solid.h"

#include <algorithm>
#include <limits>

#include "core/cancellation.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "tree/visit.h"

namespace sdm::inside {
namespace {

constexpr double kMargin = 1e-9;  // of the unit frame, far above rounding

// A segment in the unit frame, and a bound on the rounding errors of its coordinates.
struct Segment {
  Vec3 start, along;
  double rounding;

  Segment(const UnitFrame& frame, const Affine& pose, const Vec3& p, const Vec3& q) {
    const Affine back = inverse(pose);
    start = frame.to_unit(back(p));
    along = frame.to_unit(back(q)) - start;
    rounding = kDoubleRounding * (1 + norm(start) + norm(along));
  }

  [[nodiscard]] bool meets(const tree::FloatBox& box) const {
    double first = 0, last = 1;
    for (int k = 0; k < 3; ++k) {
      const double lo = box.lo[k] - rounding - start[k], hi = box.hi[k] + rounding - start[k];
      if (along[k] == 0) {
        if (lo > 0 || hi < 0) return false;
        continue;
      }
      const auto [enter, leave] = std::minmax({lo / along[k], hi / along[k]});
      first = std::max(first, enter);
      last = std::min(last, leave);
    }
    constexpr double kQuotient = 1e-12;
    return first <= last + kQuotient;
  }
};

// If the segment pq crosses the triangle: 1 if it leaves through it (p is on the inner side), −1 if it
// enters. Otherwise 0; empty if it meets an edge of the triangle. Neither p nor q lies on the triangle.
std::optional<int> crossing(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const bool above_p = orientation(t[0], t[1], t[2], p) > 0, above_q = orientation(t[0], t[1], t[2], q) > 0;
  if (above_p == above_q) return 0;
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  const bool left = a > 0 || b > 0 || c > 0, right = a < 0 || b < 0 || c < 0;
  if (left && right) return 0;
  if (a * b * c == 0) return std::nullopt;
  return above_p ? -1 : 1;
}

}  // namespace

std::optional<int> winding(const sites::SitesData& sites, const Affine& pose, const Vec3& p, const Vec3& q) {
  const Segment segment(sites.frame, pose, p, q);
  poll();
  std::optional<int> turns = 0;
  const auto enter = [&](tree::Subtree below) { return turns && segment.meets(sites.tree.box(below.root)); };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const auto [a, b, c] = sites.mesh.triangles[face];
      const auto& at = sites.mesh.positions;
      const std::optional<int> sign = crossing(p, q, {pose(at[a]), pose(at[b]), pose(at[c])});
      if (!sign) return turns.reset();
      *turns += sites.inverted[face] ? -*sign : *sign;
    }
  };
  visit(sites.tree, tree::InOrder{enter, visit_leaf});
  return turns;
}

int winding(const sites::SitesData& solid, const Affine& pose, const Vec3& point) {
  if (solid.tree.nodes.empty()) return 0;
  // The shortest way out of the box is along one of the axes of the frame of the solid.
  const tree::FloatBox& box = solid.tree.box(0);
  const Vec3 p = solid.frame.to_unit(inverse(pose)(point));
  int axis = 0;
  double way = std::numeric_limits<double>::infinity();
  bool up = false;
  for (int k = 0; k < 3; ++k) {
    const double below = p[k] - box.lo[k], above = box.hi[k] - p[k];
    if (below < -kMargin || above < -kMargin) return 0;
    if (below < way) way = below, axis = k, up = false;
    if (above < way) way = above, axis = k, up = true;
  }
  const double length = (up ? 1 : -1) * (std::abs(way) + 0.01) / solid.frame.scale;
  // Segments along (1, t, t²) that intersect an edge are skipped. Those that meet the same edge lie in one
  // plane through the point, and no such plane contains more than two of them, so that only points on an edge
  // need more than a few.
  constexpr int kMostSegments = 100;
  double t = 0.0137035999;
  for (int i = 0; i < kMostSegments; ++i, t += 0.0072973525) {
    Vec3 along;
    along[axis] = length, along[(axis + 1) % 3] = t * length, along[(axis + 2) % 3] = t * t * length;
    if (const auto turns = winding(solid, pose, point, point + pose.linear(along))) return *turns;
  }
  return 0;
}

}  // namespace sdm::inside
