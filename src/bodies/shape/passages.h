// The faces in a column.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/shape/column_box.h"
#include "bodies/shape/wall_column.h"
#include "geometry/rounding.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::shape {

/// Levels without faces are used if they are farther apart than this, in the unit frame.
inline constexpr double kLeastGap = 4 * kSingleRounding;

/// Where faces pass through a column, at levels between limits.
class Passages {
 public:
  /// Appends to `faces` the parts of faces in the column, up to `most`.
  Passages(const sites::SitesData& solid, const WallColumn& column, const Levels& limits, std::size_t most,
           std::vector<Polygon>& faces)
      : solid_(solid),
        column_(column),
        limits_(limits),
        most_(most),
        error_(kDoubleRounding * (1 / solid.frame.scale + norm(column.origin))),
        faces_(faces) {
    thread_local std::vector<tree::OpenNode> stack;
    const Search search{*this,
                        {solid.frame,
                         column.origin,
                         column.axes,
                         {lower(0), lower(1), lower(2)},
                         {upper(0), upper(1), upper(2)}}};
    tree::visit(solid.wide, stack, search);
  }

  /// Whether there are too many.
  [[nodiscard]] bool overflow() const { return overflow_; }

  /// The winding number at a level between them minus that at the origin, if it is clear.
  [[nodiscard]] std::optional<int> change(double level) const {
    if (level > 0 ? unclear_above_ < level : unclear_below_ > level) return {};
    int change = 0;
    for (const Crossing& c : std::span(crossings_).first(crossing_count_)) {
      if (std::abs(c.level) <= kUnitDistanceRounding / solid_.frame.scale) return {};
      if (level > 0 ? c.level > 0 && c.level < level : c.level < 0 && c.level > level)
        change += level > 0 ? c.change : -c.change;
    }
    return change;
  }

  /// The levels at which a polygon is, above a plane through the origin.
  [[nodiscard]] Levels levels(const Polygon& polygon, const Vec2& slope = {}) const {
    Levels levels{kInfinity, -kInfinity};
    for (const Vec3& p : std::span(polygon.corners).first(polygon.count)) {
      const double level = p[0] - slope[0] * p[1] - slope[1] * p[2];
      levels = {std::min(levels.lower, level), std::max(levels.upper, level)};
    }
    return {levels.lower - error_, levels.upper + error_};
  }

 private:
  struct Crossing {
    double level;
    int change;  // of the winding number, upwards
  };

  [[nodiscard]] double lower(int axis) const {
    return (axis == 0 ? limits_.lower : column_.lower[axis]) - error_;
  }
  [[nodiscard]] double upper(int axis) const {
    return (axis == 0 ? limits_.upper : column_.upper[axis]) + error_;
  }

  // The policy of the search for faces in the box around the column.
  struct Search {
    Passages& passages;
    ColumnBox box;

    bool enter(const tree::OpenNode&) const { return !passages.overflow_; }
    std::uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node) const {
      return box.meets(node);
    }
    void leaf(const tree::OpenNode& open) const {
      const sites::Regions& regions = passages.solid_.regions;
      const std::uint32_t leaf = open.leaf_number(), first = regions.leaves[leaf];
      const std::uint32_t used = (1u << (regions.leaves[leaf + 1] - first)) - 1;
      for (std::uint32_t near = box.meets(regions.bounds[leaf]) & used; near != 0; near &= near - 1)
        passages.add(regions.owners[first + static_cast<std::uint32_t>(std::countr_zero(near))].face);
    }
  };

  void add(std::uint32_t face) {
    Polygon polygon;
    std::array<Vec3, 3> from;
    for (int k = 0; k < 3; ++k)
      from[k] = solid_.mesh.positions[solid_.mesh.triangles[face][k]] - column_.origin;
    for (const int a : {1, 2, 0}) {
      for (int k = 0; k < 3; ++k) polygon.corners[k][a] = dot(column_.axes[a], from[k]);
      const double x = polygon.corners[0][a], y = polygon.corners[1][a], z = polygon.corners[2][a];
      if (std::max({x, y, z}) < lower(a) || std::min({x, y, z}) > upper(a)) return;
    }
    polygon.count = 3;
    cross(std::span(polygon.corners).first<3>(), solid_.inverted[face] != 0);
    if (column_.side_count == 0) {
      polygon.clip(-1, 0, -lower(1));
      polygon.clip(1, 0, upper(1));
      polygon.clip(0, -1, -lower(2));
      polygon.clip(0, 1, upper(2));
    }
    for (std::size_t i = 0; i < column_.side_count; ++i) {
      const Vec3& h = column_.sides[i];
      polygon.clip(h[0], h[1], h[2] + error_);
    }
    if (polygon.count == 0) return;
    overflow_ |= faces_.size() >= most_;
    if (!overflow_) faces_.push_back(polygon);
  }

  // Where the line through the origin along u passes through a face.
  void cross(std::span<const Vec3, 3> corners, bool inverted) {
    std::array<double, 3> areas;  // opposite to each corner
    bool left = true, right = true, clear = true;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &p = corners[(k + 1) % 3], &q = corners[(k + 2) % 3];
      areas[k] = p[1] * q[2] - p[2] * q[1];
      const double rounding = error_ * (std::abs(p[1]) + std::abs(p[2]) + std::abs(q[1]) + std::abs(q[2]));
      left &= areas[k] > -rounding;
      right &= areas[k] < rounding;
      clear &= std::abs(areas[k]) > rounding;
    }
    if (!left && !right) return;
    if (!clear || crossing_count_ == crossings_.size()) {
      const auto [lower, upper] = std::minmax({corners[0][0], corners[1][0], corners[2][0]});
      if (upper >= 0) unclear_above_ = std::min(unclear_above_, lower);
      if (lower <= 0) unclear_below_ = std::max(unclear_below_, upper);
      return;
    }
    const double level = (areas[0] * corners[0][0] + areas[1] * corners[1][0] + areas[2] * corners[2][0]) /
                         (areas[0] + areas[1] + areas[2]);
    crossings_[crossing_count_++] = {level, left != inverted ? -1 : 1};
  }

  const sites::SitesData& solid_;
  const WallColumn& column_;
  Levels limits_;
  std::size_t most_;
  double error_;
  std::vector<Polygon>& faces_;
  std::array<Crossing, 64> crossings_;
  std::size_t crossing_count_ = 0;
  bool overflow_ = false;
  // Where the winding number is not clear, from the origin.
  double unclear_above_ = kInfinity, unclear_below_ = -unclear_above_;
};

}  // namespace sdm::shape
