// Relations that the counters of the gl engine must satisfy.
#pragma once

#include <sdm/gl.h>
#include <sdm/map.h>

#include <string>
#include <vector>

#include "gl/raster_report.h"

namespace sdm::bench {

/// Returns the relations of <sdm/gl.h> that the map's report violates, as text.
[[nodiscard]] std::vector<std::string> violated_relations(const Surface& surface, const DistanceMap& map,
                                                          const gl::RasterReport& report,
                                                          const GlOptions& options);

}  // namespace sdm::bench
