// An AABB tree collapsed to eight children a node, so that vector instructions test them together.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <vector>

#include "hierarchy/aabb_tree.h"

namespace sdm::hierarchy {

struct WideTree {
  static constexpr int kWidth = 8;

  /// A child is another wide node, by its index, or a leaf of the binary tree, by its number in their order.
  [[nodiscard]] static constexpr bool is_leaf(std::uint32_t child) { return (child & kLeafBit) != 0; }
  [[nodiscard]] static constexpr std::uint32_t leaf_number(std::uint32_t child) { return child & ~kLeafBit; }
  [[nodiscard]] static constexpr std::uint32_t leaf(std::uint32_t number) { return number | kLeafBit; }

  struct Node {
    alignas(32) float lo[3][kWidth] = {};  ///< of lanes not in use 0: vector loads read them
    alignas(32) float hi[3][kWidth] = {};
    std::uint32_t child[kWidth] = {};
    std::uint32_t source[kWidth] = {};  ///< the binary node of each child
    std::uint32_t count = 0;            ///< children in use: the first ones
    std::uint32_t leaves = 0;           ///< a bit for each child that is a leaf
  };
  std::vector<Node> nodes;  ///< the root is nodes[0]; empty for an empty tree

 private:
  static constexpr std::uint32_t kLeafBit = 0x80000000u;
};

/// Squared distances of a box to those of a node's children.
inline void squared_distances(const WideTree::Node& node, const Box& box,
                              double (&squared)[WideTree::kWidth]) {
  for (int i = 0; i < WideTree::kWidth; ++i) squared[i] = 0;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < WideTree::kWidth; ++i) {
      const double gap = std::max({node.lo[k][i] - box.hi[k], box.lo[k] - node.hi[k][i], 0.0});
      squared[i] += gap * gap;
    }
}

/// Opens the child of largest area until a node is full. Cost: linear.
[[nodiscard]] WideTree collapse(const AabbTree& tree);

/// Copies the boxes of the refitted binary tree. Cost: linear.
void refit(WideTree& wide, const AabbTree& tree);

}  // namespace sdm::hierarchy
