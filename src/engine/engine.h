// The one interface of the engines: closest sites for points that come in an order where neighbours are near
// each other.
#pragma once

#include <sdm/map.h>

#include <functional>
#include <span>

#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::engine {

/// Receives closest points as they are found: those of the points from index `first`.
using ClosestSink = std::function<void(std::size_t first, const sites::ClosestPacket& closest)>;

/// Finds, for each point, the closest point of O2 within max_distance; type `none` where there is none. One
/// thread; called for batches of points from several threads at once.
using ClosestSearch = void (*)(const sites::SitesData& sites, std::span<const Vec3> points,
                               double max_distance, const ClosestSink& deliver);

/// The search of an engine.
ClosestSearch search_of(EngineKind engine);

}  // namespace sdm::engine
