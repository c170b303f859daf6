// Inside or outside of a closed mesh, by counting the crossings of a ray.
#pragma once

#include <sdm/types.h>

#include <span>

#include "geometry/unit_frame.h"
#include "tree/visit.h"

namespace sdm::inside {

/// The faces of a mesh, with a tree over them.
struct FaceTree {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const UnitFrame& frame;
  const tree::AabbTree& tree;  ///< in the frame
};

/// Whether the ray from `origin` meets a box, or a triangle.
[[nodiscard]] bool ray_meets(const tree::FloatBox& box, const Vec3& origin);
[[nodiscard]] bool ray_meets(const Triangle& t, std::span<const Vec3> positions, const UnitFrame& frame,
                             const Vec3& origin);

/// Calls visit(face) for each face of the tree that a ray from `origin`, a point in the unit frame, meets: of
/// each closed shell, an odd number if the point is inside and an even number if it is outside. Undefined for
/// shells that contain the point. Allocates nothing. Cost: O(log n), plus linear in the faces met.
template <class Visit>
void for_each_crossing(const FaceTree& faces, const Vec3& origin, const Visit& visit) {
  const auto enter = [&](tree::Subtree below) { return ray_meets(faces.tree.box(below.root), origin); };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : faces.tree.items_of(leaf))
      if (ray_meets(faces.triangles[face], faces.positions, faces.frame, origin)) visit(face);
  };
  tree::visit(faces.tree, tree::InOrder{enter, visit_leaf});
}

}  // namespace sdm::inside
