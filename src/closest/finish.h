// Closest points in double on the sites selected in single precision.
#pragma once

#include <span>

#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::closest {

/// Delivers the closest point of each query on its winner, if the query lies in that site's region of
/// influence. Otherwise walks from there with closest_around_face, or searches for it alone (closest_point)
/// where the walk does not settle it. Type none beyond max_distance, and where there is no winner.
void finish(const sites::SitesData& sites, std::span<const std::uint32_t> winners,
            std::span<const Vec3> queries, double max_distance, const sites::ClosestSink& deliver);

}  // namespace sdm::closest
