// Invariants of the gl engine's counters.
#pragma once

#include <sdm/map.h>

#include <string>
#include <vector>

namespace sdm::bench {

/// The laws of <sdm/gl.h> that the map's report breaks, in words; none if all is well.
[[nodiscard]] std::vector<std::string> broken_laws(const Surface& surface, const DistanceMap& map,
                                                   const GlOptions& options);

}  // namespace sdm::bench
