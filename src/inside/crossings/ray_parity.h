// Inside or outside of a closed mesh, by counting the crossings of a ray.
#pragma once

#include <sdm/types.h>

#include <span>

#include "hierarchy/aabb_tree.h"
#include "mesh/topology.h"

namespace sdm::inside {

/// The faces of a mesh, with a tree over them.
struct FaceTree {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const UnitFrame& frame;
  const hierarchy::AabbTree& tree;  ///< in the frame
};

/// Whether a ray from `origin`, a point in the unit frame, meets the faces of the tree an odd number of
/// times, leaving out the faces of one component (kNone: none). Undefined for points on the mesh. Allocates
/// nothing. Cost: O(log n), plus linear in the faces met.
[[nodiscard]] bool odd_crossings(const FaceTree& faces, const Vec3& origin,
                                 std::span<const std::uint32_t> component = {},
                                 std::uint32_t left_out = kNone);

}  // namespace sdm::inside
