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

/// The topology of a mesh without duplicate faces.
struct TopologyBefore {
  const Topology& topology;
  const VertexFaces& faces;
};

/// Sets the topology, and the faces of vertices, to those that build_topology() and vertex_faces() would
/// return after the edit. Returns false, and sets nothing, if there are duplicate faces then. Cost: copying
/// the edges and the faces of vertices, plus the edges of vertices of changed faces.
[[nodiscard]] bool edit_topology(const TriangleEdit& edit, const TopologyBefore& before, Topology& topology,
                                 VertexFaces& faces);

}  // namespace sdm::mesh
