#include <sdm/error.h>
#include <sdm/map.h>

#include <new>

#include "core/memory.h"
#include "sites/sites_data.h"

namespace sdm {

std::vector<std::uint8_t> boundary_mask(const Sites& sites, const DistanceMap& map) try {
  const mesh::Topology& topology = internals(sites).topology;
  std::vector<std::uint8_t> edges(topology.edges.size()), vertices(sites.mesh().positions.size());
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (topology.edge_faces(e).size() == 1)
      edges[e] = vertices[topology.edges[e][0]] = vertices[topology.edges[e][1]] = 1;
  const auto of = [](const std::vector<std::uint8_t>& flags, std::uint32_t site) {
    if (site >= flags.size()) throw Error("boundary_mask() needs a map to the same mesh");
    return flags[site];
  };
  std::vector<std::uint8_t> mask(map.site.size());
  for (std::size_t t = 0; t < mask.size(); ++t) {
    if (map.site_type[t] == SiteType::edge) mask[t] = of(edges, map.site[t]);
    if (map.site_type[t] == SiteType::vertex) mask[t] = of(vertices, map.site[t]);
  }
  return mask;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the mask of a boundary");
}

}  // namespace sdm
