// Which neighbours bound the region of a vertex.
#pragma once

#include <sdm/types.h>

#include <span>

#include "sites/regions.h"

namespace sdm::sites {

/// Chooses neighbours on all sides of a vertex: each is the one most opposed to the sum of the directions to
/// those chosen before. This avoids leaving a half-space of directions open, in which the cone would extend
/// far. If there are fewer than kRays, the first one is repeated. `scale` maps the positions to the unit
/// frame.
[[nodiscard]] std::array<std::uint32_t, VertexRegion::kRays> choose_cone_rays(
    std::span<const Vec3> positions, double scale, std::uint32_t vertex,
    std::span<const std::uint32_t> neighbours);

}  // namespace sdm::sites
