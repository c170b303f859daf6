// Convex parts of a triangle, clipped to the cells of a grid.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "geometry/clip.h"
#include "geometry/vec.h"

namespace sdm::surface {

/// A convex polygon within a triangle of the atlas. Each corner stores its atlas coordinates and its weights:
/// the point is vertex 0 + weights[0] (vertex 1 − vertex 0) + weights[1] (vertex 2 − vertex 0), wherever the
/// vertices are. Weights are carried along where corners are cut, so that slivers need no inverse map.
class Polygon {
 public:
  struct Corner {
    Vec2 at, weights;
  };

  /// Clipping by a line adds one corner, or at most n/2 where rounding has made n corners slightly
  /// non-convex. Four lines turn three corners into at most 13.
  static constexpr std::size_t kMostCorners = 13;

  explicit Polygon(const std::array<Vec2, 3>& triangle) {
    add({triangle[0], {0, 0}});
    add({triangle[1], {1, 0}});
    add({triangle[2], {0, 1}});
  }

  [[nodiscard]] std::span<const Corner> corners() const { return {corners_.data(), count_}; }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// The part where side · (at[axis] − line) ≥ 0; side is 1 or −1. The coordinate of new corners along the
  /// axis is that of the line, bit-identical.
  [[nodiscard]] Polygon clipped(int axis, double line, double side) const {
    std::array<double, kMostCorners> height;
    for (std::size_t i = 0; i < count_; ++i) height[i] = side * (corners_[i].at[axis] - line);
    Polygon part;
    clip_convex(
        {height.data(), count_}, [&](std::size_t i) { part.add(corners_[i]); },
        [&](std::size_t i, std::size_t j, double t) {
          const Corner &a = corners_[i], &b = corners_[j];
          Corner cut{a.at + t * (b.at - a.at), a.weights + t * (b.weights - a.weights)};
          cut.at[axis] = line;
          part.add(cut);
        });
    return part;
  }
  [[nodiscard]] Polygon between(int axis, double lo, double hi) const {
    return clipped(axis, lo, 1).clipped(axis, hi, -1);
  }

  /// The extent along an axis.
  [[nodiscard]] std::array<double, 2> range(int axis) const {
    const auto [lo, hi] = std::ranges::minmax(corners(), {}, [axis](const Corner& c) { return c.at[axis]; });
    return {lo.at[axis], hi.at[axis]};
  }
  /// The extent along the other axis of the points on a line of this axis, along which the polygon was
  /// clipped; lo > hi if there are none.
  [[nodiscard]] std::array<double, 2> range_on(int axis, double line) const {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Corner& c : corners())
      if (c.at[axis] == line) {
        lo = std::min(lo, c.at[1 - axis]);
        hi = std::max(hi, c.at[1 - axis]);
      }
    return {lo, hi};
  }

 private:
  Polygon() = default;
  void add(const Corner& corner) { corners_[count_++] = corner; }

  std::array<Corner, kMostCorners> corners_;
  std::size_t count_ = 0;
};

/// The corners of a square [x, x + 1] × [y, y + 1] that lie in a triangle.
struct SquareCorners {
  bool upper_left, upper_right, lower_left, lower_right;

  /// Whether there is an end of each diagonal. The part of the square in the triangle then extends half the
  /// longer diagonal from the centre, and no farther, under any affine map. This is so wherever a single line
  /// clips the square and the centre remains.
  [[nodiscard]] bool both_diagonals() const {
    return (upper_left || lower_right) && (upper_right || lower_left);
  }
};

/// Calls visit(x, y, corners, part) for the squares [x, x + 1] × [y, y + 1] that the triangle meets, in rows;
/// part() is the part of the triangle in the square, which may be empty. The parts cover the triangle. Cost:
/// linear in squares.
template <class Visit>
void for_each_square(const std::array<Vec2, 3>& triangle, Visit visit) {
  const Polygon whole(triangle);
  const auto [top, bottom] = whole.range(1);
  double y = std::floor(top);
  do {
    const Polygon row = whole.between(1, y, y + 1);
    if (row.empty()) continue;
    const std::array<double, 2> upper = row.range_on(1, y), lower = row.range_on(1, y + 1);
    const auto within = [](const std::array<double, 2>& range, double x) {
      return range[0] <= x && x <= range[1];
    };
    const auto [left, right] = row.range(0);
    double x = std::floor(left);
    do
      visit(x, y,
            SquareCorners{within(upper, x), within(upper, x + 1), within(lower, x), within(lower, x + 1)},
            [&] { return row.between(0, x, x + 1); });
    while (++x < right);
  } while (++y < bottom);
}

}  // namespace sdm::surface
