// Normals at the vertices of a mesh.
#pragma once

#include <sdm/mesh.h>

#include <vector>

namespace sdm::mesh {

/// The sum of the unit normals of the faces around each vertex, weighted by their angles at it; 0 where these
/// cancel or have no area. Cost: linear.
[[nodiscard]] std::vector<Vec3> vertex_normals(const Mesh& mesh);

}  // namespace sdm::mesh
