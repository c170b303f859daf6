// Whether a topology that was read from a file is that of the mesh.
#pragma once

#include <sdm/mesh.h>

#include <span>

#include "mesh/topology.h"

namespace sdm::mesh {

/// Whether the edges, and the faces of edges and vertices, are those of the faces that are not ignored, and
/// every face with repeated corners is. Triangles must be valid. Cost: linear.
[[nodiscard]] bool is_topology(const Topology& topology, const VertexFaces& vertex_faces, const Mesh& mesh);

/// Whether none is larger than 1. Cost: linear.
[[nodiscard]] bool are_flags(std::span<const std::uint8_t> flags);

/// Whether each face has a component, and each component a face, except for ignored ones. Cost: linear.
[[nodiscard]] bool is_orientation(const Orientation& orientation, const Topology& topology);

}  // namespace sdm::mesh
