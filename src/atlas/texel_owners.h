// The texel table: which face owns each texel.
#pragma once

#include <cstdint>
#include <vector>

#include "atlas/layout.h"

namespace sdm::atlas {

/// Returns for each texel the face whose triangle in the atlas contains its centre, or kNone. Every chart
/// owns at least one texel, except for AtlasKind::uv, where faces may overlap: `overlapping` is set to the
/// number of centres that lie in a face that does not own them, by more than rounding.
[[nodiscard]] std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind,
                                                   std::uint32_t resolution, std::uint32_t rows,
                                                   std::size_t& overlapping);

/// Gives the free texels of further charts, which overlap no others, to their faces; returns these texels.
/// Every chart owns at least one.
[[nodiscard]] std::vector<std::uint32_t> rasterise_added(std::span<const std::vector<std::uint32_t>> charts,
                                                         const std::vector<std::array<Vec2, 3>>& corners,
                                                         std::uint32_t resolution,
                                                         std::vector<std::uint32_t>& owner);

}  // namespace sdm::atlas
