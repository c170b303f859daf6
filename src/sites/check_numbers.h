// Whether the numbers of sites that were read from a file are finite, and no larger than those of any sites.
// All are false for NaN.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "geometry/unit_frame.h"
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
/// The same of the faces of leaves, which are nodes: the other lanes hold what the vertices at 0 give.
[[nodiscard]] bool have_limits(std::span<const tree::AabbTree::Node> nodes,
                               std::span<const std::uint32_t> leaves, std::span<const FaceBounds> bounds,
                               float largest_radius);

/// Whether all indices are less than the count.
[[nodiscard]] bool are_below(std::span<const std::uint32_t> indices, std::size_t count);
/// Whether those of corners are less than `points`, and those of faces less than `faces`.
[[nodiscard]] bool are_below(std::span<const SitePlaces::Edge> edges, std::size_t points, std::size_t faces);

/// A point in the unit frame, and 0: two vectors of two numbers, or one of four.
using PaddedPoint = std::array<double, 4>;
/// Whether points, and those of regions, are those of the mesh, to the bit. Sets `placed` to them. Their
/// vertices must be valid.
[[nodiscard]] bool are_placed(const UnitFrame& frame, std::span<const Vec3> positions,
                              std::span<const UnitVertex> points, std::span<const VertexRegion> regions,
                              std::span<PaddedPoint> placed);
/// Whether the boxes of leaves contain the corners of their faces.
[[nodiscard]] bool contain(std::span<const tree::AabbTree::Node> nodes, std::span<const std::uint32_t> leaves,
                           std::span<const Triangle> corners, std::span<const PaddedPoint> placed);

}  // namespace sdm::sites
