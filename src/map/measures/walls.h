// The walls of a solid at a sample of its surface, for all that is asked of them.
#pragma once

#include <sdm/measure.h>
#include <sdm/sites.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sdm::thickness {

/// The number of rays that a wall estimate and thin_walls() have unless another is asked for.
inline constexpr std::size_t kWallSamples = 4096;

/// Returns the lengths of rays into the solid from points that are evenly distributed over its area, in
/// increasing order, infinite where nothing is measured; empty if there is no solid. Cost: as of
/// estimate_walls().
[[nodiscard]] std::vector<double> wall_lengths(const Sites& sites, std::size_t samples = kWallSamples);

/// thin_walls() of such lengths. Cost: O(1).
[[nodiscard]] double thin_walls(std::span<const double> lengths);
/// estimate_walls() of such lengths. Cost: O(log n).
[[nodiscard]] std::optional<WallEstimate> estimate_walls(std::span<const double> lengths, double thin);

}  // namespace sdm::thickness
