// Which neighbours bound the region of a vertex.
#pragma once

#include <sdm/types.h>

#include <span>

#include "sites/regions.h"

namespace sdm::sites {

/// Chooses neighbours of a vertex on all its sides: each the most opposed to the sum of the directions to
/// those chosen before, so that no half of the directions around the vertex is left open, in which its cone
/// would reach far out. Where there are fewer than kRays, the first stands for the rest. `scale` brings the
/// positions to the unit frame.
[[nodiscard]] std::array<std::uint32_t, VertexRegion::kRays> choose_cone_rays(
    std::span<const Vec3> positions, double scale, std::uint32_t vertex,
    std::span<const std::uint32_t> neighbours);

}  // namespace sdm::sites
