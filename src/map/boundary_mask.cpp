#include <sdm/error.h>
#include <sdm/map.h>

#include <new>

#include "core/memory.h"
#include "inside/open_sides.h"
#include "sites/sites_data.h"

namespace sdm {

std::vector<std::uint8_t> boundary_mask(const Sites& sites, const DistanceMap& map) try {
  const inside::BoundarySites boundary(internals(sites).topology, sites.mesh().positions.size());
  std::vector<std::uint8_t> mask(map.site.size());
  for (std::size_t t = 0; t < mask.size(); ++t) {
    const SiteType type = map.site_type[t];
    const std::size_t count = type == SiteType::edge     ? boundary.edges.size()
                              : type == SiteType::vertex ? boundary.vertices.size()
                                                         : 0;
    if (count > 0 && map.site[t] >= count) throw Error("boundary_mask() needs a map to the same mesh");
    mask[t] = boundary.contains(type, map.site[t]) ? 1 : 0;
  }
  return mask;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the mask of a boundary");
}

}  // namespace sdm
