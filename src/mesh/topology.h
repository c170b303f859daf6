// Edges and their incident faces, for any triangle soup.
#pragma once

#include <sdm/types.h>

#include <span>

#include "core/arrays/rows.h"

namespace sdm::mesh {

/// Edges and their incident faces. Faces with repeated corners, and duplicates of an earlier face (same three
/// vertices, in any order), are *ignored*: they have no edges here.
struct Topology {
  Array<std::array<std::uint32_t, 2>> edges;       ///< (smaller, larger) vertex, lexicographic order
  Array<std::array<std::uint32_t, 3>> face_edges;  ///< edges (v0 v1), (v1 v2), (v2 v0); kNone if ignored
  CompressedRows<std::uint32_t> incident;          ///< faces of each edge, in increasing order
  std::size_t duplicate_faces = 0;
  std::size_t collapsed_faces = 0;  ///< faces with repeated corners

  [[nodiscard]] std::span<const std::uint32_t> edge_faces(std::size_t edge) const {
    return incident.of(edge);
  }
  /// Whether every edge has exactly two faces.
  [[nodiscard]] bool closed() const;
  [[nodiscard]] bool ignored(std::size_t face) const { return face_edges[face][0] == kNone; }

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [edges, face_edges, incident, duplicate_faces, collapsed_faces] = self;
    visit(edges);
    visit(face_edges);
    visit(incident);
    visit(duplicate_faces);
    visit(collapsed_faces);
  }
};

/// Cost: O(n log d), d the largest valence, all cores.
[[nodiscard]] Topology build_topology(std::size_t vertex_count, std::span<const Triangle> triangles);

/// Which faces to flip so that neighbours across two-face edges are consistently oriented,
/// flipping the fewer faces of each component of such neighbours; `orientable` is false when no choice
/// satisfies all of them. Ignored faces are not flipped.
struct Orientation {
  Array<std::uint8_t> flipped;      ///< 1 for each face to flip
  Array<std::uint32_t> component;   ///< of each face, over two-face edges; kNone if ignored
  Array<std::uint32_t> first_face;  ///< of each component
  bool orientable = true;

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [flipped, component, first_face, orientable] = self;
    visit(flipped);
    visit(component);
    visit(first_face);
    visit(orientable);
  }
};
[[nodiscard]] Orientation orient(std::span<const Triangle> triangles, const Topology& topology);

/// Faces of each vertex, in increasing order, ignored ones excluded.
using VertexFaces = CompressedRows<std::uint32_t>;
[[nodiscard]] VertexFaces vertex_faces(std::size_t vertex_count, std::span<const Triangle> triangles,
                                       const Topology& topology);

/// Whether the faces of a vertex form one fan, open or closed: each edge at the vertex has at most two of
/// them, and a walk from any of them across both of its edges reaches them all.
[[nodiscard]] bool is_fan(const Topology& topology, std::uint32_t vertex,
                          std::span<const std::uint32_t> faces);

/// Whether the face traverses its k-th edge from the smaller to the larger vertex.
inline bool runs_forward(const Triangle& triangle, int k) {
  return triangle[k] < triangle[k < 2 ? k + 1 : 0];
}

}  // namespace sdm::mesh
