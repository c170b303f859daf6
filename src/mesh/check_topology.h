// Whether a topology that was read from a file is that of the mesh.
#pragma once

#include <sdm/mesh.h>

#include "mesh/topology.h"

namespace sdm::mesh {

/// Whether the edges, and the faces of edges and vertices, are those of the faces that are not ignored, and
/// every face with repeated corners is. Triangles must be valid. Cost: linear.
[[nodiscard]] bool is_topology(const Topology& topology, const VertexFaces& vertex_faces, const Mesh& mesh);

/// Whether each face has a component, and each component a face, except for ignored ones. Cost: linear.
[[nodiscard]] bool is_orientation(const Orientation& orientation, const Topology& topology);

/// Whether rows have increasing offsets up to the number of items. Cost: linear.
[[nodiscard]] bool are_rows(const CompressedRows<std::uint32_t>& rows, std::size_t count);

}  // namespace sdm::mesh
