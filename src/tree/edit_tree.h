// An AABB tree after items were removed and added.
#pragma once

#include <functional>

#include "tree/aabb_tree.h"

namespace sdm::tree {

struct TreeEdit {
  std::span<const std::uint8_t> kept;    ///< of each item of the tree by its number: 0 to remove it
  std::span<const std::uint32_t> added;  ///< items
  /// The box of an item that stays or is added, in the frame of the tree's boxes.
  std::function<FloatBox(std::uint32_t item)> box_of;
};

/// Removes and adds items. Nodes without items disappear; an added item goes to the leaf that it enlarges
/// least on the way down, and leaves of more than `leaf_size` items are built into subtrees. There must be an
/// item before and after. Boxes are not up to date: refit them. Many edits at one place can exceed kDeepest.
/// Cost: a copy of the tree, plus n log n in the added items.
[[nodiscard]] AabbTree edit_tree(const AabbTree& tree, const TreeEdit& edit, std::uint32_t leaf_size);

/// Adds the nodes and items of another tree behind those of a forest. Its root is the first node added; its
/// items keep their numbers. Cost: linear in what is added.
void append(AabbTree& forest, const AabbTree& tree);

}  // namespace sdm::tree
