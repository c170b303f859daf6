// Outward normals of the sites of a closed, orientable mesh, for telling inside from outside (Bærentzen &
// Aanæs 2005): with c the closest point of the mesh to q and n the pseudonormal of the site that c lies on, q
// is outside where (q − c)·n > 0.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

#include "mesh/topology.h"

namespace sdm {

struct Pseudonormals {
  std::vector<Vec3> face;  ///< unit length, 0 for faces without area
  std::vector<Vec3>
      vertex;  ///< sum of incident face normals, each weighted by the face's angle at the vertex
};

/// The pseudonormal of an edge: the sum of its faces' normals.
[[nodiscard]] Vec3 edge_pseudonormal(const Pseudonormals& normals, const Topology& topology,
                                     std::uint32_t edge);

/// `inverted[f]` tells that face f's vertices run clockwise seen from outside. Cost: linear, all cores.
[[nodiscard]] Pseudonormals build_pseudonormals(std::span<const Vec3> positions,
                                                std::span<const Triangle> triangles,
                                                const VertexFaces& vertex_faces,
                                                std::span<const std::uint8_t> inverted);

}  // namespace sdm
