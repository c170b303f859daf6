// An AABB tree collapsed to eight children a node, so that one instruction sequence tests them together.
#pragma once

#include <sdm/types.h>

#include <vector>

#include "hierarchy/aabb_tree.h"

namespace sdm::hierarchy {

struct WideTree {
  static constexpr int kWidth = 8;
  /// A child is another wide node, or (with this bit) a leaf: the number of the binary tree's leaf, in order.
  static constexpr std::uint32_t kLeafBit = 0x80000000u;

  struct Node {
    alignas(32) float lo[3][kWidth] = {};  ///< of lanes not in use 0: vector loads read them
    alignas(32) float hi[3][kWidth] = {};
    std::uint32_t child[kWidth] = {};
    std::uint32_t source[kWidth] = {};  ///< the binary node of each child
    std::uint32_t count = 0;            ///< children in use: the first ones
  };
  std::vector<Node> nodes;  ///< the root is nodes[0]; empty for an empty tree
};

/// Opens the child of largest area until a node is full. Cost: linear.
[[nodiscard]] WideTree collapse(const AabbTree& tree);

/// Copies the boxes of the refitted binary tree. Cost: linear.
void refit(WideTree& wide, const AabbTree& tree);

}  // namespace sdm::hierarchy
