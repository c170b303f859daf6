// Which of many bodies is nearest, at every texel of one.
#pragma once

#include <sdm/bodies.h>

#include <span>

#include "query/body.h"

namespace sdm {

/// As Bodies::nearest_map.
void map_nearest(std::span<const Body> bodies, std::size_t on, double max_distance, NearestMap& nearest);

}  // namespace sdm
