// Outward normals of the sites of a closed, orientable mesh, which distinguish inside from outside (Bærentzen
// & Aanæs 2005): with c the closest point of the mesh to q and n the pseudonormal of the site that c lies on,
// q is outside where (q − c)·n > 0.
#pragma once

#include <sdm/sites.h>

#include "mesh/topology.h"

namespace sdm::sites {

struct Pseudonormals {
  Array<Vec3> face;    ///< unit length, 0 for faces without area and ignored ones
  Array<Vec3> vertex;  ///< sum of its faces' normals, weighted by their angles at it

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [face, vertex] = self;
    visit(face);
    visit(vertex);
  }
};

/// The pseudonormal of the site of a closest point; of an edge, the sum of its faces' normals.
[[nodiscard]] Vec3 pseudonormal(const Pseudonormals& normals, const mesh::Topology& topology,
                                const ClosestPoint& closest);

}  // namespace sdm::sites
