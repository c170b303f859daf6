// The part of a slice of a grid in which a site is drawn.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "gl/polygons/convex_polygon.h"
#include "research/fields/drawn_sites.h"

namespace sdm::fields {

/// A rectangle of a slice; coordinates in a slice are those of its points, (i, j).
struct SliceRect {
  Vec2 lower, upper;

  [[nodiscard]] bool empty() const { return !(lower[0] <= upper[0] && lower[1] <= upper[1]); }
};

/// A slice of a grid: a plane of constant z.
class Slice {
 public:
  Slice(const UnitGrid& grid, std::uint32_t k) : grid_(grid), z_(grid.at(2, k)) {}

  [[nodiscard]] double z() const { return z_; }
  /// The distance between the slice and a site along z.
  [[nodiscard]] double gap(const DrawnSite& site) const {
    return std::max({0.0, site.box.lower[2] - z_, z_ - site.box.upper[2]});
  }
  /// All points, with half a cell around them.
  [[nodiscard]] SliceRect whole() const { return {{-0.5, -0.5}, {grid_.dims[0] - 0.5, grid_.dims[1] - 0.5}}; }
  /// The part of whole() within `radius` of the site along x and y.
  [[nodiscard]] SliceRect around(const DrawnSite& site, double radius) const {
    SliceRect rect = whole();
    for (int k = 0; k < 2; ++k) {
      rect.lower[k] = std::max(rect.lower[k], (site.box.lower[k] - radius - grid_.origin[k]) / grid_.step[k]);
      rect.upper[k] = std::min(rect.upper[k], (site.box.upper[k] + radius - grid_.origin[k]) / grid_.step[k]);
    }
    return rect;
  }

  /// Cuts the rectangle by the first `walls` walls of the site's region, moved outwards by `slack`.
  [[nodiscard]] gl::ConvexPolygon clip(const SliceRect& rect, const SiteRegion& region, int walls,
                                       double slack) const {
    gl::ConvexPolygon polygon;
    if (rect.empty()) return polygon;
    bool whole_rect = true;
    for (int w = 0; w < walls; ++w) {
      HalfPlane wall = restrict(region.walls[w]);
      wall.value += slack;
      double least = wall.value, most = wall.value;  // over the rectangle
      for (int k = 0; k < 2; ++k) {
        const double a = wall.gradient[k] * rect.lower[k], b = wall.gradient[k] * rect.upper[k];
        least += std::min(a, b);
        most += std::max(a, b);
      }
      if (most < 0) return {};
      if (least >= 0) continue;
      if (whole_rect) polygon = gl::ConvexPolygon::rectangle(rect.lower, rect.upper);
      whole_rect = false;
      polygon.cut(wall);
      if (polygon.empty()) return polygon;
    }
    return whole_rect ? gl::ConvexPolygon::rectangle(rect.lower, rect.upper) : polygon;
  }

  /// Cuts the polygon by −distance ≤ (x − anchor)·axis ≤ distance.
  void clip_by_plane_distance(gl::ConvexPolygon& polygon, const SiteRegion& region, double distance) const {
    const double at = dot(region.axis, region.anchor);
    for (const double sign : {1.0, -1.0}) {
      HalfPlane side = restrict({sign * region.axis, sign * at - distance});
      polygon.cut(side);
    }
  }

  [[nodiscard]] Vec3 step_along_row() const { return {grid_.step[0], 0, 0}; }
  [[nodiscard]] Vec3 point(const Vec2& uv) const { return {grid_.at(0, uv[0]), grid_.at(1, uv[1]), z_}; }

 private:
  [[nodiscard]] HalfPlane restrict(const HalfSpace& wall) const {
    return {wall.normal[0] * grid_.origin[0] + wall.normal[1] * grid_.origin[1] + wall.normal[2] * z_ -
                wall.offset,
            {wall.normal[0] * grid_.step[0], wall.normal[1] * grid_.step[1]}};
  }

  const UnitGrid& grid_;
  double z_;
};

/// The points of a polygon in its rows: for row first + r, those from begin[r] to end[r] − 1. Memory is
/// reused.
class PolygonRows {
 public:
  /// The rows of `polygon` from `row` to `row_end` − 1, of a slice with `width` points per row.
  void find(const gl::ConvexPolygon& polygon, std::uint32_t row, std::uint32_t row_end, std::uint32_t width) {
    count_ = 0;
    const auto corners = polygon.corners();
    if (corners.empty()) return;
    double lower = corners[0][1], upper = lower;
    for (const Vec2& c : corners) {
      lower = std::min(lower, c[1]);
      upper = std::max(upper, c[1]);
    }
    const double low = std::max(std::ceil(lower), row + 0.0),
                 high = std::min(std::floor(upper), row_end - 1.0);
    if (!(low <= high)) return;
    first_ = static_cast<std::uint32_t>(low);
    count_ = static_cast<std::uint32_t>(high) - first_ + 1;
    left_.assign(count_, 1e300);
    right_.assign(count_, -1e300);
    for (std::size_t a = 0; a < corners.size(); ++a) {
      const Vec2 &p = corners[a], &q = corners[a + 1 < corners.size() ? a + 1 : 0];
      const Vec2 &below = p[1] <= q[1] ? p : q, &above = p[1] <= q[1] ? q : p;
      const double from = std::max(std::ceil(below[1]), low), to = std::min(std::floor(above[1]), high);
      const double height = above[1] - below[1];
      const double slope = height > 0 ? (above[0] - below[0]) / height : 0;
      const double leftmost = std::min(p[0], q[0]), rightmost = std::max(p[0], q[0]);
      for (double v = from; v <= to; ++v) {
        const auto r = static_cast<std::uint32_t>(v) - first_;
        const double u = std::clamp(below[0] + (v - below[1]) * slope, leftmost, rightmost);
        left_[r] = std::min(left_[r], height > 0 ? u : leftmost);
        right_[r] = std::max(right_[r], height > 0 ? u : rightmost);
      }
    }
    width_ = width;
  }

  [[nodiscard]] std::uint32_t first() const { return first_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// The points of row first() + r: [begin, end).
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> points(std::uint32_t r) const {
    const double begin = std::max(std::ceil(left_[r]), 0.0),
                 end = std::min(std::floor(right_[r]) + 1, width_ + 0.0);
    if (!(begin < end)) return {0, 0};
    return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }

 private:
  std::uint32_t first_ = 0, count_ = 0, width_ = 0;
  std::vector<double> left_, right_;
};

}  // namespace sdm::fields
