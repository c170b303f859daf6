// Meshes as the solids that they bound.
#pragma once

#include <optional>

#include "proximity/exact/pair_search.h"

namespace sdm {

/// Whether a mesh bounds a solid: it is closed and orientable.
[[nodiscard]] inline bool is_solid(const SitesData& sites) {
  return sites.closed && sites.orientation.orientable;
}

/// How often the faces of a closed mesh moved by `pose`, turned outwards, wind around p: told by the segment
/// to a point q outside the mesh. Nothing where that meets an edge. Exact, if p does not lie on the surface.
/// Cost: O(log n) and the faces that the segment meets.
[[nodiscard]] std::optional<int> winding(const SitesData& sites, const Affine& pose, const Vec3& p,
                                         const Vec3& q, std::vector<std::uint32_t>& stack);

/// Whether a solid moved by `pose` contains a point that does not lie on its surface: whether its faces
/// wind around the point. Exact. Cost: that of `winding`, most often once.
[[nodiscard]] bool contains(const SitesData& solid, const Affine& pose, const Vec3& point,
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
