// The closest points of O2, for groups of points and for single ones.
#pragma once

#include <span>

#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::closest {

/// Groups of neighbouring `points` descend through the wide tree and through candidate lists in single
/// precision; the winner is evaluated in double. A winner can differ from the closest site only where the two
/// distances are equal up to rounding, about 10⁻⁷ of the scene's extent. Passes the closest points to the
/// sink in order, on the calling thread; type none where nothing is within max_distance.
void closest_points(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                    const sites::ClosestSink& sink);

}  // namespace sdm::closest
