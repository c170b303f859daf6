// The gl engine: the paper's Algorithm 1 on OpenGL.
#pragma once

#include <sdm/map.h>

#include <vector>

namespace sdm {

/// For each texel of the surface, a face of O2 that the closest site belongs to, found in single precision;
/// kNone where no face of O1 owns the texel, or nothing lies within options.max_distance. Throws sdm::Error
/// where OpenGL fails, or sdm was built without; Cancelled.
[[nodiscard]] std::vector<std::uint32_t> gl_winners(const Surface& surface, const Sites& sites,
                                                    const MapOptions& options, RasterReport& report);

}  // namespace sdm
