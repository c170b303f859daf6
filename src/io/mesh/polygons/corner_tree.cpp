#include "io/mesh/polygons/corner_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "geometry/spatial_order.h"

namespace sdm::io {
namespace {

// The points mapped to the unit square, since spatial_order works in single precision. Halved first, so that
// no difference of finite coordinates overflows.
std::vector<Vec3> to_unit_square(std::span<const Vec2> points) {
  std::vector<Vec3> result(points.size());
  for (int k = 0; k < 2; ++k) {
    double low = kInfinity, high = -low;
    for (const Vec2& p : points) {
      low = std::min(low, p[k] / 2);
      high = std::max(high, p[k] / 2);
    }
    const double size = std::max(high - low, std::numeric_limits<double>::min());
    for (std::size_t p = 0; p < points.size(); ++p) result[p][k] = (points[p][k] / 2 - low) / size;
  }
  return result;
}

}  // namespace

void CornerTree::reset(std::span<const Vec2> points) {
  points_ = points;
  corner_of_leaf_ = spatial_order(to_unit_square(points));
  leaf_of_corner_.resize(points.size());
  for (std::uint32_t leaf = 0; leaf < points.size(); ++leaf) leaf_of_corner_[corner_of_leaf_[leaf]] = leaf;
  leaves_ = std::bit_ceil(points.size());
  boxes_.assign(2 * leaves_, Box{});
}

void CornerTree::set(std::uint32_t corner, bool present) {
  std::size_t node = leaves_ + leaf_of_corner_[corner];
  Box box = present ? Box{points_[corner], points_[corner]} : Box{};
  while (boxes_[node] != box) {
    boxes_[node] = box;
    if (node == 1) return;
    const Box& sibling = boxes_[node ^ 1];
    for (int k = 0; k < 2; ++k) {
      box.low[k] = std::min(box.low[k], sibling.low[k]);
      box.high[k] = std::max(box.high[k], sibling.high[k]);
    }
    node /= 2;
  }
}

// Separating axes: those of the box, then the normals of the triangle's edges.
bool CornerTree::may_overlap(const Box& box, const std::array<Vec2, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  for (int k = 0; k < 2; ++k)
    if (box.low[k] > std::max({a[k], b[k], c[k]}) || box.high[k] < std::min({a[k], b[k], c[k]})) return false;
  if (box.low == box.high && (box.low == a || box.low == b || box.low == c)) return false;
  for (int k = 0; k < 3; ++k) {
    // cross(to − from, p − from) is largest at one corner of the box. If it is negative there by more than
    // rounding, all p in the box lie outside the edge.
    const Vec2 &from = triangle[k], &to = triangle[(k + 1) % 3];
    const double x = to[0] - from[0], y = to[1] - from[1];
    const double greatest = x * ((x > 0 ? box.high[1] : box.low[1]) - from[1]) -
                            y * ((y > 0 ? box.low[0] : box.high[0]) - from[0]);
    const double size =
        std::abs(x) * std::max(std::abs(box.low[1] - from[1]), std::abs(box.high[1] - from[1])) +
        std::abs(y) * std::max(std::abs(box.low[0] - from[0]), std::abs(box.high[0] - from[0]));
    constexpr double kCrossRounding = 8 * std::numeric_limits<double>::epsilon();
    if (!(greatest >= -kCrossRounding * size)) return false;
  }
  return true;
}

}  // namespace sdm::io
