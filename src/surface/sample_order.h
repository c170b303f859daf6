// The order of a surface's samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sdm::surface {

class SurfaceData;

/// Samples that engines measure at once.
inline constexpr std::size_t kPacket = 16;

/// The samples, those of texels and of faces without one, in an order such that every aligned run of 16·2^k
/// of them lies in a small box on the surface, as geometry/spatial_order.h describes. Squares of 4² texels of
/// one chart stay together: they are small boxes already, and there are far fewer of them to sort. Does not
/// use SurfaceData::samples. Cost: linear in texels, plus n log n in squares and in texels beside them; all
/// cores.
[[nodiscard]] std::vector<std::uint32_t> sample_order(const SurfaceData& surface);

}  // namespace sdm::surface
