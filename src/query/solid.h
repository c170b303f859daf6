// Meshes as the solids that they bound.
#pragma once

#include "query/pair_search.h"

namespace sdm {

/// Whether a mesh bounds a solid: it is closed and orientable.
[[nodiscard]] inline bool is_solid(const Sites::Impl& sites) {
  return sites.closed && sites.orientation.orientable;
}

/// Whether a solid moved by `pose` contains a point that does not lie on its surface: whether its faces,
/// turned outwards, wind around the point. Exact. Cost: O(log n) and the faces that a ray meets.
[[nodiscard]] bool contains(const Sites::Impl& solid, const Affine& pose, const Vec3& point,
                            std::vector<std::uint32_t>& stack);

/// Whether a solid contains a component of the other mesh, if the surfaces do not intersect. Each component
/// is looked at: one may lie inside while another is outside. Cost: `contains` for each component whose first
/// corner lies in the solid's box.
[[nodiscard]] bool one_contains_part_of_other(const MeshPair& pair, PairWorkspace& workspace);

/// Whether the surfaces intersect, or a solid contains a part of the other mesh.
[[nodiscard]] inline bool colliding(const MeshPair& pair, PairWorkspace& workspace) {
  return find_intersection(pair, workspace).intersecting || one_contains_part_of_other(pair, workspace);
}

}  // namespace sdm
