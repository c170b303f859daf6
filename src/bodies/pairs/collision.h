// Whether two meshes collide.
#pragma once

#include "bodies/pairs/pair_search.h"

namespace sdm::pairs {

/// Whether a solid contains a component of the other mesh, provided that the surfaces do not intersect. Tests
/// each component, since one may lie inside while another is outside. Cost: one call of `contains` for each
/// component whose first corner lies in the solid's box.
[[nodiscard]] bool one_contains_part_of_other(const MeshPair& pair);

/// Whether the surfaces intersect, or a solid contains part of the other mesh.
[[nodiscard]] inline bool colliding(const MeshPair& pair, PairWorkspace& workspace) {
  return find_common_faces(pair, workspace) != kNoFaces || one_contains_part_of_other(pair);
}

}  // namespace sdm::pairs
