// The boundary of an open mesh.
#pragma once

#include <sdm/sites.h>

#include <cstdint>
#include <vector>

#include "mesh/topology.h"

namespace sdm::inside {

/// Flags of the edges with one face, and of their vertices.
struct BoundarySites {
  std::vector<std::uint8_t> edges, vertices;

  BoundarySites() = default;
  BoundarySites(const mesh::Topology& topology, std::size_t vertex_count)
      : edges(topology.edges.size()), vertices(vertex_count) {
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (topology.edge_faces(e).size() == 1)
        edges[e] = vertices[topology.edges[e][0]] = vertices[topology.edges[e][1]] = 1;
  }

  [[nodiscard]] bool contains(SiteType type, std::uint32_t site) const {
    return (type == SiteType::edge && edges[site] != 0) || (type == SiteType::vertex && vertices[site] != 0);
  }
};

}  // namespace sdm::inside
