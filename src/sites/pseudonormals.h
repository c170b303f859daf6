// Outward normals of the sites of a closed, orientable mesh, which distinguish inside from outside (Bærentzen
// & Aanæs 2005): with c the closest point of the mesh to q and n the pseudonormal of the site that c lies on,
// q is outside where (q − c)·n > 0.
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

#include "mesh/topology.h"

namespace sdm::sites {

struct Pseudonormals {
  std::vector<Vec3> face;    ///< unit length, 0 for faces without area and ignored ones
  std::vector<Vec3> vertex;  ///< sum of its faces' normals, weighted by their angles at it
};

/// The pseudonormal of the site of a closest point; of an edge, the sum of its faces' normals.
[[nodiscard]] Vec3 pseudonormal(const Pseudonormals& normals, const mesh::Topology& topology,
                                const ClosestPoint& closest);

}  // namespace sdm::sites
