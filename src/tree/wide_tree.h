// An AABB tree collapsed to eight children per node, which vector instructions test together.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tree/aabb_tree.h"

namespace sdm::tree {

struct WideTree {
  static constexpr int kWidth = 8;

  /// A child is the index of another wide node, or of a leaf of the binary tree, counted in tree order.
  [[nodiscard]] static constexpr bool is_leaf(std::uint32_t child) { return (child & kLeafBit) != 0; }
  [[nodiscard]] static constexpr std::uint32_t leaf_number(std::uint32_t child) { return child & ~kLeafBit; }
  [[nodiscard]] static constexpr std::uint32_t leaf(std::uint32_t number) { return number | kLeafBit; }

  struct Node {
    alignas(32) float lower[3][kWidth] = {};  ///< 0 in unused lanes: vector loads read them
    alignas(32) float upper[3][kWidth] = {};
    std::uint32_t child[kWidth] = {};
    std::uint32_t source[kWidth] = {};  ///< node of the binary tree for each child
    std::uint32_t count = 0;            ///< children in use, which come first
    std::uint32_t leaves = 0;           ///< a bit for each child that is a leaf
    std::uint32_t padding[6] = {};      ///< 0, so that stored trees have no bytes without a value
  };
  Array<Node> nodes;  ///< the root is nodes[0]; empty for an empty tree

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [nodes] = self;
    visit(nodes);
  }

 private:
  static constexpr std::uint32_t kLeafBit = 0x80000000u;
};

/// Squared distances from a box to the boxes of a node's children, at most 1e-6 of themselves too large.
inline void squared_distances(const WideTree::Node& node, const FloatBox& box,
                              float (&squared)[WideTree::kWidth]) {
  for (int i = 0; i < WideTree::kWidth; ++i) squared[i] = 0;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < WideTree::kWidth; ++i) {
      const float gap =
          std::max(std::max(node.lower[k][i] - box.upper[k], box.lower[k] - node.upper[k][i]), 0.0f);
      squared[i] += gap * gap;
    }
}

/// Collapses a tree: a node's child of largest area is replaced by its children until there are eight. Cost:
/// linear.
[[nodiscard]] WideTree collapse(const AabbTree& tree);

/// Copies the boxes of the binary tree after a refit. Cost: linear.
void refit(WideTree& wide, const AabbTree& tree);

/// Whether the nodes form one tree in depth-first order, not deeper than kDeepest, whose leaves divide the
/// items into runs of at most `leaf_size`; each box contains those of its children, and no coordinate is
/// beyond `largest_coordinate`. Cost: linear.
[[nodiscard]] bool is_tree(const AabbTree& tree, std::uint32_t leaf_size, float largest_coordinate);

/// Whether the nodes form one tree, parents before children, whose children stand for nodes of the binary
/// tree and have their boxes: those of a node divide the leaves of the one that it stands for. The binary
/// tree must be one. Cost: linear.
[[nodiscard]] bool is_tree(const WideTree& wide, const AabbTree& tree);

}  // namespace sdm::tree
