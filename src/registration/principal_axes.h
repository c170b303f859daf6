// Poses from centres and principal axes.
#pragma once

#include <span>
#include <vector>

#include "geometry/affine.h"

namespace sdm::registration {

/// The 24 rigid motions that move the centre and the principal axes of one set of points to those of another.
struct AxisMatches {
  std::vector<Affine> poses;
  /// Those that keep the order of the axes by their moments come first: 4, or all if two axes have moments
  /// within a quarter of each other.
  std::size_t likely = 4;
};

/// Points farther from the centre than five times the median distance do not count. Both sets must have
/// points.
[[nodiscard]] AxisMatches axis_matches(std::span<const Vec3> from, std::span<const Vec3> to);

/// The medians of the coordinates, and the rms distance from there of the points that count.
struct Extent {
  Vec3 centre{};
  double radius = 0;
};
[[nodiscard]] Extent robust_extent(std::span<const Vec3> points);

}  // namespace sdm::registration
