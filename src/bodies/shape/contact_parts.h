// The parts of a surface that have one contact each.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <vector>

#include "tree/aabb_tree.h"

namespace sdm::shape {

/// The size of a part relative to that of the mesh: finer details have no contacts of their own.
inline constexpr double kContactPart = 1.0 / 16;

/// A node of the tree.
struct ContactPart {
  /// The highest node, among this one and those above it, whose box has at most the size of a part as its
  /// diagonal; kNone if there is none. Parts follow the surface as it deforms, so that they identify
  /// contacts.
  std::uint32_t part = kNone;
  std::uint32_t first_leaf = 0, last_leaf = 0;  ///< its leaves have the numbers first_leaf ... last_leaf − 1
};

/// One for each node. Cost: linear.
[[nodiscard]] std::vector<ContactPart> contact_parts(const tree::AabbTree& tree);

}  // namespace sdm::shape
