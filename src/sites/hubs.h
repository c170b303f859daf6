// Pairs of faces that may intersect, also where many faces share a vertex or an edge.
#pragma once

#include <sdm/progress.h>

#include <cstdint>
#include <functional>

#include "sites/sites_data.h"

namespace sdm::sites {

/// Calls visit(face, face), from any thread, for all pairs of faces that may have a point in common beyond
/// the corners and edges that they share, each once, until it returns false. Polls. Cost: O(n log n), plus
/// linear in the pairs visited. These have boxes that overlap. All faces at a vertex do: where these are
/// many, only pairs whose directions from the vertex overlap are visited.
void for_each_near_pair(const SitesData& sites, const Progress& progress,
                        const std::function<bool(std::uint32_t, std::uint32_t)>& visit);

}  // namespace sdm::sites
