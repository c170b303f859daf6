// Outward normals of the sites of a closed, orientable mesh, for telling inside from outside (Bærentzen &
// Aanæs 2005): with c the closest point of the mesh to q and n the pseudonormal of the site that c lies on, q
// is outside where (q − c)·n > 0.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

#include "mesh/regions.h"
#include "mesh/topology.h"

namespace sdm {

struct Pseudonormals {
  std::vector<Vec3> face;    ///< unit length, 0 for faces without area
  std::vector<Vec3> vertex;  ///< sum of its faces' normals, weighted by their angles at it
};

/// The pseudonormal of an edge: the sum of its faces' normals.
[[nodiscard]] Vec3 edge_pseudonormal(const Pseudonormals& normals, const Topology& topology,
                                     std::uint32_t edge);

/// From outward normals of faces. The angles' errors of 1e-7 can turn a sign only where q − c is as near to a
/// right angle with n: no farther from it than single precision tells q − c. Cost: linear, all cores.
[[nodiscard]] Pseudonormals build_pseudonormals(FaceShapes faces, std::span<const Triangle> triangles,
                                                const VertexFaces& vertex_faces);

}  // namespace sdm
