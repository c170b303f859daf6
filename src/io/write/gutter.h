// Values for the free texels around charts, so that filtering at a chart's border does not blend in the
// background.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>

namespace sdm::io {

/// How far, in texels, values extend beyond the charts: bilinear filtering needs 1, the rest is for smaller
/// mip levels.
inline constexpr int kGutter = 4;

/// The owned texel nearest to (x, y): the texel itself if it is owned; kNone if there is none within kGutter
/// texels. `owners`: resolution² values, kNone for a free texel.
[[nodiscard]] std::uint32_t gutter_source(std::uint32_t resolution, std::span<const std::uint32_t> owners,
                                          std::uint32_t x, std::uint32_t y);

}  // namespace sdm::io
