// An order of points in which consecutive points are near each other in space.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

namespace sdm::core {

/// Indices of the points such that every aligned run of 16·2^k points lies in a small box: the points are
/// split in half along the longest side of their box, recursively, down to packets of sixteen. Cost: O(n log
/// n), all cores.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
