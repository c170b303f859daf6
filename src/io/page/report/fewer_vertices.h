// A coarser copy of a mesh whose vertices keep their values.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

struct FewerVertices {
  Mesh mesh;                          ///< vertices in the order of their first use by a triangle
  std::vector<float> distances;       ///< one for each of its vertices
  std::vector<std::uint32_t> vertex;  ///< of each of its vertices, that of the mesh
};

/// Of the vertices in each cell of a grid only the one of the largest |distance| is left; triangles whose
/// corners are in three cells remain. The cells are as wide as it takes for at most `most` triangles.
/// Positions and distances are those of the mesh. Cost: linear.
[[nodiscard]] FewerVertices fewer_vertices(const Mesh& mesh, std::span<const float> distances,
                                           std::size_t most);

}  // namespace sdm::io
