// Invariants of the gl engine's counters.
#pragma once

#include <sdm/gl.h>
#include <sdm/map.h>

#include <string>
#include <vector>

namespace sdm::bench {

/// The laws of <sdm/gl.h> that the report of a map breaks, in words; none if all is well.
[[nodiscard]] std::vector<std::string> broken_laws(const Surface& surface, const DistanceMap& map, const GlReport& report,
                                                   const GlOptions& options);

}  // namespace sdm::bench
