// Closest points on the sites that single precision found, in double.
#pragma once

#include <span>

#include "engine/cpu/descent.h"
#include "engine/engine.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

/// Delivers for each query the closest point of its winner, if the query lies in that site's region of
/// influence; else the walk of closest_around_face from there, or the reference engine where it is unsettled.
/// Type none beyond max_distance, and where there is no winner.
void finish(const sites::SitesData& sites, std::span<const std::uint32_t> winners,
            std::span<const Vec3> queries, double max_distance, const engine::ClosestSink& deliver);

}  // namespace sdm::cpu
