// Topology after an edit of the triangles.
#pragma once

#include "mesh/topology.h"

namespace sdm::mesh {

/// An edit by which vertices and faces keep their numbers.
struct TriangleEdit {
  std::span<const Triangle> before, after;  ///< faces may follow those before
  std::span<const std::uint32_t> changed;   ///< faces of `before` with other corners now, each once
  std::size_t vertex_count;                 ///< now
};

/// Updates the topology of a mesh without duplicate faces, and the faces of its vertices, to those that
/// build_topology() and vertex_faces() would return. Returns false, and changes nothing, if there are
/// duplicate faces now. Cost: copying the edges and the faces of vertices, plus the edges of vertices of
/// changed faces.
[[nodiscard]] bool edit_topology(const TriangleEdit& edit, Topology& topology, VertexFaces& faces);

}  // namespace sdm::mesh
