// Splits points into the blocks that are searched together.
#pragma once

#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/surface.h>

#include <functional>
#include <span>
#include <string_view>

namespace sdm::closest {

/// The largest block. Blocks have a power-of-four size and are aligned, so the points of a block are
/// neighbours where all points are in an order like that of geometry/spatial_order.h.
inline constexpr std::size_t kLargestBlock = 1 << 16;

/// The size of the blocks of `count` points.
[[nodiscard]] std::size_t block_size(std::size_t count);

/// Calls body(begin, end) for blocks of `count` points, on all cores. Blocks are as large as load balancing
/// permits. Reports progress, and throws Cancelled, as parallel_for does.
void for_each_block(std::size_t count, const Progress& progress, std::string_view step,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

/// The same for the samples of a surface; `body` receives their points.
void for_each_sample_block(const Surface& surface, const Progress& progress, std::string_view step,
                           const std::function<void(std::size_t begin, std::span<const Vec3> points)>& body);
/// The same for a range of them that begins and ends with blocks.
void for_each_sample_block(const Surface& surface, const SampleRange& range, const Progress& progress,
                           std::string_view step,
                           const std::function<void(std::size_t begin, std::span<const Vec3> points)>& body);

}  // namespace sdm::closest
