// Half-edges, from which topologies are built.
#pragma once

#include <sdm/types.h>

#include <span>

namespace sdm::mesh {

/// An edge of a face, directed as in the face; stored in the list of its smaller vertex.
struct HalfEdge {
  std::uint32_t larger;    ///< vertex
  std::uint32_t opposite;  ///< vertex of the face
  std::uint32_t corner;    ///< 3f + k: from corner k of face f to the next
};

/// The contribution of one vertex to the arrays of a topology.
struct Share {
  std::uint32_t edges = 0, half_edges = 0;

  friend Share operator+(const Share& a, const Share& b) {
    return {a.edges + b.edges, a.half_edges + b.half_edges};
  }
};

inline bool repeats_a_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Sorts the half-edges of a vertex by edge, then by face. Those of duplicate faces, which have the same
/// three vertices as a half-edge of an earlier face, move to the end and are not counted.
Share sort_half_edges(std::span<HalfEdge> half_edges);

}  // namespace sdm::mesh
