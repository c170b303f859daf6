// Normals for drawing a mesh.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sdm::io {

/// One normal for each smooth sheet of faces at a vertex: faces whose normals differ by more than 40° from
/// the first face of a sheet are of another one. A normal is the mean of its faces', weighted by their angles
/// at the vertex.
struct ShadingNormals {
  std::vector<Vec3f> normals;                        ///< unit vectors
  std::vector<std::uint32_t> vertex;                 ///< the vertex of each normal
  std::vector<std::array<std::uint32_t, 3>> corner;  ///< the normal of each corner of each face
};

/// Removed faces have no normals. Faces without area take the normals of others, or (0, 0, 1). Cost: linear.
[[nodiscard]] ShadingNormals shading_normals(const Mesh& mesh);

}  // namespace sdm::io
