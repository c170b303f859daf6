// The nearest of many bodies at every texel of one of them.
#pragma once

#include <sdm/multi_body_query.h>

#include <span>

#include "bodies/shape/posed_body.h"

namespace sdm::bodies {

/// Throws sdm::Error unless all bodies are meshes without a margin.
void require_meshes(std::span<const shape::PosedBody> bodies);

/// See MultiBodyQuery::nearest_map.
void map_nearest(std::span<const shape::PosedBody> bodies, std::size_t on, double max_distance,
                 NearestMap& nearest);

}  // namespace sdm::bodies
