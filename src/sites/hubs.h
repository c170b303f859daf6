// Pairs of faces that may intersect, also where many faces share a vertex or an edge.
#pragma once

#include <sdm/execution.h>

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "sites/sites_data.h"

namespace sdm::sites {

using FacePair = std::array<std::uint32_t, 2>;

inline constexpr std::uint64_t kAllPairs = std::numeric_limits<std::uint64_t>::max();

/// Calls visit(pairs), from any thread, for pairs of faces that may have a point in common beyond the corners
/// and edges that they share, until it returns false; each pair is visited once. At most `most` pairs that
/// come near each other are looked at, the same ones for any number of threads; returns whether these are
/// all. Polls. Cost: O(n log n), plus linear in the pairs looked at. Those visited have boxes that overlap.
/// All faces at a vertex do: where these are many, only pairs whose directions from the vertex overlap are
/// looked at.
bool for_each_near_pair(const SitesData& sites, std::uint64_t most, const Progress& progress,
                        const std::function<bool(std::span<const FacePair> pairs)>& visit);

}  // namespace sdm::sites
