#include "io/mesh/polygons/triangulate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

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

// Smaller polygons are searched corner by corner. Where corners are collinear up to rounding, the index's
// boxes exclude some that the test of single corners would not, and so other ears may be chosen.
constexpr std::size_t kIndexedCorners = 1024;

// Newell's normal of a polygon, which need not be planar: twice the area vector.
Vec3 area_vector(std::span<const Vec3> points) {
  Vec3 n{};
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    n += cross(points[i] - points[0], points[i + 1] - points[0]);
  return n;
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

// Drops the largest coordinate of the polygon's normal, which keeps the orientation and makes no area vanish.
void Triangulator::project() {
  const Vec3 n = area_vector(points_);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) > std::abs(n[k])) k = i;
  int i = (k + 1) % 3, j = (k + 2) % 3;
  if (n[k] < 0) std::swap(i, j);
  plane_.resize(points_.size());
  for (std::size_t p = 0; p < points_.size(); ++p) plane_[p] = {points_[p][i], points_[p][j]};
}

// Twice the signed area of a triangle; positive if a, b, c have the polygon's orientation.
double Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return cross(plane_[b] - plane_[a], plane_[c] - plane_[a]);
}

// Whether p lies in the triangle or on its boundary. Corners that coincide with one of the triangle's belong
// to bridges to holes and do not count.
bool Triangulator::blocks(std::uint32_t p, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  if (plane_[p] == plane_[a] || plane_[p] == plane_[b] || plane_[p] == plane_[c]) return false;
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// A corner is an ear if it is convex and no other corner blocks its triangle. If any corner blocks it, a
// non-convex one does.
bool Triangulator::is_ear(std::uint32_t b) const {
  if (!corners_[b].convex) return false;
  const std::uint32_t a = corners_[b].previous, c = corners_[b].next;
  if (indexed_)
    return !reflex_.any_in({plane_[a], plane_[b], plane_[c]},
                           [&](std::uint32_t p) { return blocks(p, a, b, c); });
  for (std::uint32_t p = corners_[c].next; p != a; p = corners_[p].next)
    if (!corners_[p].convex && blocks(p, a, b, c)) return false;
  return true;
}

Triangulator::Rank Triangulator::rank(std::uint32_t corner) const {
  return {corners_[corner].ear ? Kind::ear : Kind::other, corners_[corner].cut};
}

// The ear with the shortest diagonal; if a self-intersecting polygon has no ear, the corner with the shortest
// diagonal. Of equal ones, the first from `start` on.
std::uint32_t Triangulator::best_ear(std::uint32_t start) const {
  if (indexed_) return static_cast<std::uint32_t>(ranks_.least_from(start));
  std::uint32_t best = start;
  for (std::uint32_t c = corners_[start].next; c != start; c = corners_[c].next)
    if (corners_[c].ear != corners_[best].ear ? corners_[c].ear : corners_[c].cut < corners_[best].cut)
      best = c;
  return best;
}

void Triangulator::link_corners() {
  const auto n = static_cast<std::uint32_t>(points_.size());
  corners_.resize(n);
  for (std::uint32_t b = 0; b < n; ++b) {
    const std::uint32_t a = b == 0 ? n - 1 : b - 1, c = b + 1 == n ? 0 : b + 1;
    corners_[b] = {a, c, turn(a, b, c) > 0, false, squared_norm(points_[c] - points_[a])};
  }
  indexed_ = n > kIndexedCorners;
  if (indexed_) {
    reflex_.reset(plane_);
    for (std::uint32_t c = 0; c < n; ++c)
      if (!corners_[c].convex) reflex_.set(c, true);
  }
  for (std::uint32_t c = 0; c < n; ++c) corners_[c].ear = is_ear(c);
  if (indexed_) {
    std::vector<Rank> ranks(n);
    for (std::uint32_t c = 0; c < n; ++c) ranks[c] = rank(c);
    ranks_.reset(ranks, {Kind::clipped, 0});
  }
}

void Triangulator::clip(std::uint32_t ear) {
  const std::uint32_t previous = corners_[ear].previous, next = corners_[ear].next;
  triangles_.push_back({previous, ear, next});
  if (indexed_) {
    reflex_.set(ear, false);
    ranks_.set(ear, {Kind::clipped, 0});
  }
  corners_[previous].next = next;
  corners_[next].previous = previous;
  for (const std::uint32_t b : {previous, next}) {
    const std::uint32_t a = corners_[b].previous, c = corners_[b].next;
    corners_[b].convex = turn(a, b, c) > 0;
    if (indexed_) reflex_.set(b, !corners_[b].convex);
    corners_[b].ear = is_ear(b);
    corners_[b].cut = squared_norm(points_[c] - points_[a]);
    if (indexed_) ranks_.set(b, rank(b));
  }
}

std::span<const std::array<std::uint32_t, 3>> Triangulator::triangulate(std::span<const Vec3> points) {
  triangles_.clear();
  if (points.size() == 3) {
    triangles_.push_back({0, 1, 2});
    return triangles_;
  }
  points_ = points;
  project();
  link_corners();
  std::uint32_t any = 0;
  for (std::size_t left = points.size(); left > 3; --left) {
    const std::uint32_t ear = best_ear(any);
    any = corners_[ear].next;
    clip(ear);
  }
  triangles_.push_back({corners_[any].previous, any, corners_[any].next});
  return triangles_;
}

}  // namespace sdm::io
