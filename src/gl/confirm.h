// The closest points of texels in double precision, from what was drawn in single precision.
#pragma once

#include <span>

#include "gl/draw_winners.h"

namespace sdm::gl {

/// Passes on the closest points of samples, from the winners of their texels. Returns the number of texels
/// whose winner was not confirmed; for these, and for samples that are no texels, the cpu engine found the
/// closest site.
std::size_t confirm(const sites::SitesData& sites, const RasterWinners& winners,
                    std::span<const std::uint32_t> texels, std::span<const Vec3> points, double max_distance,
                    const sites::ClosestSink& sink);

}  // namespace sdm::gl
