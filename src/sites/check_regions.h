// Whether regions that were read from a file belong to the sites.
#pragma once

#include "sites/sites_data.h"

namespace sdm::sites {

/// Whether the regions have an entry for each face, edge, vertex and leaf of the sites, and refer to them:
/// all but the numbers that bounds and regions consist of, which may be any. The mesh, the topology and the
/// trees must be valid. Cost: linear, all cores.
[[nodiscard]] bool match(const SitesData& sites);

}  // namespace sdm::sites
