// Whether the numbers of sites that were read from a file are finite, and no larger than those of any sites.
// All are false for NaN.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sites/regions.h"
#include "tree/aabb_tree.h"

namespace sdm::sites {

/// Coordinates and lengths in the unit frame are less than this: its cube has sides of 2.
inline constexpr float kUnitReach = 8;

/// Whether no number is larger in magnitude than the limit, which is at least 0.
[[nodiscard]] bool are_within(std::span<const float> numbers, float limit);
[[nodiscard]] bool are_within(std::span<const double> numbers, double limit);

/// Indices may be any.
[[nodiscard]] bool have_limits(std::span<const FaceRegion> faces);
[[nodiscard]] bool have_limits(std::span<const EdgeRegion> edges);
[[nodiscard]] bool have_limits(std::span<const VertexRegion> vertices);
/// Of the first `count` faces: the other lanes hold what the vertices at 0 give.
[[nodiscard]] bool have_limits(const FaceBounds& bounds, std::uint32_t count, float largest_radius);

/// A point in the unit frame, and 0: two vectors of two numbers, or one of four.
using PaddedPoint = std::array<double, 4>;
/// Whether the box contains the corners of the triangles.
[[nodiscard]] bool contains(const tree::FloatBox& box, std::span<const Triangle> triangles,
                            std::span<const PaddedPoint> points);

}  // namespace sdm::sites
