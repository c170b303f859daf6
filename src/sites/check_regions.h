// Whether regions that were read from a file belong to the sites.
#pragma once

#include "sites/sites_data.h"

namespace sdm::sites {

/// Whether the regions have an entry for each face, edge, vertex and leaf of the sites, and refer to them;
/// boxes of leaves contain their faces, points are those of the mesh, to the bit, and all other numbers are
/// finite and no larger than those of any sites. Regions and normals may still be wrong: then searches may
/// find other sites than the closest ones, or none. The mesh, the topology and the trees must be valid. Cost:
/// linear, all cores.
[[nodiscard]] bool match(const SitesData& sites);

}  // namespace sdm::sites
