// Points cut into the blocks that engines are called for.
#pragma once

#include <sdm/progress.h>
#include <sdm/surface.h>

#include <functional>
#include <span>
#include <string_view>

namespace sdm::engine {

/// No block has more points. Blocks are aligned: of a power of four points, they are neighbours if the points
/// are in the order of core/spatial_order.h.
inline constexpr std::size_t kLargestBlock = 1 << 16;

/// Calls body(begin, end) for blocks of `count` points, on all cores: as large as possible, but enough of
/// them to distribute evenly. Reports progress, and throws Cancelled, as parallel_for does.
void for_each_block(std::size_t count, const Progress& progress, std::string_view step,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

/// The same for the samples of a surface, with the points at which they are.
void for_each_sample_block(const Surface& surface, const Progress& progress, std::string_view step,
                           const std::function<void(std::size_t begin, std::span<const Vec3> points)>& body);

}  // namespace sdm::engine
