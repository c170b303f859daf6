// An order of points in which neighbours are near each other in space.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

namespace sdm {

/// The indices of the points along a Morton curve through their bounds. Cost: O(n log n).
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points);

}  // namespace sdm
