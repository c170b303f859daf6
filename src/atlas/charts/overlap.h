// Whether triangles in the plane overlap: exactly, on integer coordinates.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "atlas/charts/chart.h"

namespace sdm::atlas {

/// Coordinates lie in [0, 2^29]: differences fit 30 bits with their sign, products 58, so that an orientation
/// determinant, the difference of two products, is exact in 64 bits.
using GridPoint = std::array<std::int32_t, 2>;
inline constexpr std::int32_t kGridSteps = 1 << 29;

/// Counter-clockwise, or of zero area.
using GridTriangle = std::array<GridPoint, 3>;

/// Twice the signed area.
constexpr std::int64_t orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return std::int64_t{b[0] - a[0]} * (c[1] - a[1]) - std::int64_t{b[1] - a[1]} * (c[0] - a[0]);
}

/// The tests that a chart of so many faces is worth. Nearly every pair of a fan of many slivers needs one:
/// such a chart is cut instead of tested in full.
constexpr std::uint64_t pair_budget(std::size_t faces) {
  return 10'000'000 + 100 * std::uint64_t{faces};
}

/// Two triangles whose interiors intersect, if any do. With `slack` > 0, overlaps no deeper than this, in
/// grid steps, are ignored. Triangles of zero area overlap nothing. After about `budget` tests the search
/// stops and returns an arbitrary pair, which serves callers that split the set. Cost: linear for triangles
/// of similar size.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> find_overlap(
    std::span<const GridTriangle> triangles, double slack = 0, std::uint64_t budget = UINT64_MAX);

/// All such pairs, without slack; nothing if they are more than `most`, or after `budget` tests. Cost: as
/// above.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> find_overlaps(
    std::span<const GridTriangle> triangles, std::size_t most, std::uint64_t budget = UINT64_MAX);

/// The faces in the chart's projection on a grid across it, right and up seen from outside:
/// counter-clockwise, except where snapping flips them.
[[nodiscard]] std::vector<GridTriangle> snap(const Mesh& mesh, const Chart& chart);

}  // namespace sdm::atlas
