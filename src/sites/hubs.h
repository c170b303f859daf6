// Pairs of faces that may intersect, also where many faces share a vertex or an edge.
#pragma once

#include <sdm/progress.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "sites/sites_data.h"

namespace sdm::sites {

using FacePair = std::array<std::uint32_t, 2>;

/// Calls visit(count, pairs), from any thread, for `count` pairs of faces after the other, of which `pairs`
/// may have a point in common beyond the corners and edges that they share, until it returns false; each pair
/// is visited once. Polls. Cost: O(n log n), plus linear in the pairs counted. Those visited have boxes that
/// overlap. All faces at a vertex do: where these are many, only pairs whose directions from the vertex
/// overlap are counted.
void for_each_near_pair(const SitesData& sites, const Progress& progress,
                        const std::function<bool(std::size_t count, std::span<const FacePair> pairs)>& visit);

}  // namespace sdm::sites
