// An order of points along a space-filling curve.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::core {

/// Indices of the points along a Morton curve through a grid of 1024³ cells that fills the part of `box` with
/// points; points outside belong to the nearest cell, points of one cell are in the order of their indices.
/// Neighbours in this order are mostly near each other, at a fraction of the time of spatial_order(), which
/// also bounds how far. Cost: O(n), all cores.
[[nodiscard]] std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Box& box);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
