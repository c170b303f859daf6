// Intersections of the faces of one mesh.
#pragma once

#include <cstdint>

#include "geometry/triangle.h"
#include "tree/visit_pairs.h"

namespace sdm::sites {

/// The faces of a mesh, with a tree over them.
struct FaceSoup {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const tree::AabbTree& tree;

  [[nodiscard]] Corners corners(std::uint32_t face) const { return corners_of(positions, triangles[face]); }
};

/// Whether two different faces have a point in common beyond the corners and edges that they share. Faces
/// without area have no such points. Exact.
[[nodiscard]] bool faces_intersect(const FaceSoup& mesh, std::uint32_t a, std::uint32_t b);

/// Whether the boxes of two nodes overlap.
[[nodiscard]] inline bool overlap(const tree::AabbTree& tree, const tree::NodePair& pair) {
  const tree::FloatBox &a = tree.box(pair[0]), &b = tree.box(pair[1]);
  for (int k = 0; k < 3; ++k)
    if (a.upper[k] < b.lower[k] || b.upper[k] < a.lower[k]) return false;
  return true;
}

}  // namespace sdm::sites
