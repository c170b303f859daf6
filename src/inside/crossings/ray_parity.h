// Inside or outside of a closed mesh by counting how often a ray meets it.
#pragma once

#include <sdm/types.h>

#include <span>

#include "hierarchy/aabb_tree.h"
#include "mesh/topology.h"

namespace sdm::inside {

/// Faces of a mesh under a tree.
struct FaceTree {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const UnitFrame& frame;
  const hierarchy::AabbTree& tree;  ///< in the frame
};

/// Whether a ray from `origin`, a point in the unit frame, meets the faces of the tree an odd number of
/// times, leaving out the faces of one component (kNone: none). Not defined on the mesh itself. Allocates
/// nothing. Cost: O(log n) and the faces met.
[[nodiscard]] bool odd_crossings(const FaceTree& faces, const Vec3& origin,
                                 std::span<const std::uint32_t> component = {},
                                 std::uint32_t left_out = kNone);

}  // namespace sdm::inside
