// Whether two meshes collide.
#pragma once

#include "inside/inside.h"
#include "proximity/exact/pair_search.h"

namespace sdm::exact {

/// Whether a solid contains a component of the other mesh, if the surfaces do not intersect. Each component
/// is looked at: one may lie inside while another is outside. Cost: `contains` for each component whose first
/// corner lies in the solid's box.
[[nodiscard]] bool one_contains_part_of_other(const MeshPair& pair);

/// Whether the surfaces intersect, or a solid contains a part of the other mesh.
[[nodiscard]] inline bool colliding(const MeshPair& pair, PairWorkspace& workspace) {
  return find_intersection(pair, workspace).intersecting || one_contains_part_of_other(pair);
}

}  // namespace sdm::exact
