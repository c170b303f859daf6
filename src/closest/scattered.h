// The closest points of O2, for points in any order.
#pragma once

#include <sdm/execution.h>
#include <sdm/sites.h>

#include <functional>
#include <span>

#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::closest {

/// Sets found[i] to the closest point of points[i], with a face of its site, on all cores. Points that lie
/// much closer together than the faces of O2 are searched in groups, as closest_points() does. For others,
/// and for a few thousand points in any case, the result is that of closest_point(), and does not depend on
/// the other points. Reports progress and throws Cancelled, as parallel_for does. Cost: an order of the
/// points, and a search for each.
void find_scattered(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                    const Progress& progress, std::span<ClosestPoint> found);

/// Finds the closest points of a block, as Engine::closest_points().
using BlockSearch = std::function<void(std::span<const Vec3> points, const sites::ClosestSink& sink)>;

/// Sets found[i] to the closest point of points[i], with a face of its site: by searches for blocks of points
/// that follow each other in `order`, on all cores.
void find_in_blocks(const sites::SitesData& sites, std::span<const Vec3> points,
                    std::span<const std::uint32_t> order, const BlockSearch& search, const Progress& progress,
                    std::span<ClosestPoint> found);

}  // namespace sdm::closest
