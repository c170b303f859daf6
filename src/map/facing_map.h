// Maps whose distances are to the faces of O2 that face the samples.
#pragma once

#include <sdm/map.h>

#include "engine/engine.h"

namespace sdm::map {

/// compute_map() with options.facing, by this engine.
void compute_facing_map(const Surface& surface, const Sites& sites, const MapOptions& options,
                        const Engine& engine, DistanceMap& map);

}  // namespace sdm::map
