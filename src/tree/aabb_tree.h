// A binary tree of axis-aligned boxes: building, refitting, editing. visit.h has its searches.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "core/arrays/array.h"

namespace sdm::tree {

/// A box in single precision, rounded outwards: it contains the box that it is made from.
struct FloatBox {
  std::array<float, 3> lower, upper;

  static FloatBox around(const Box& box);
};

/// The union of two boxes.
inline FloatBox unite(const FloatBox& a, const FloatBox& b) {
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = std::min(a.lower[k], b.lower[k]);
    box.upper[k] = std::max(a.upper[k], b.upper[k]);
  }
  return box;
}

/// Half the area of the surface of a box.
inline float half_area(const FloatBox& box) {
  const float x = box.upper[0] - box.lower[0], y = box.upper[1] - box.lower[1],
              z = box.upper[2] - box.lower[2];
  return x * y + y * z + z * x;
}

/// The distance between two boxes, or a box and a point, along each axis; 0 where they overlap.
inline Vec3 gap(const FloatBox& a, const FloatBox& b) {
  Vec3 gap;
  for (int k = 0; k < 3; ++k)
    gap[k] = std::max({0.0, double{a.lower[k]} - b.upper[k], double{b.lower[k]} - a.upper[k]});
  return gap;
}
inline Vec3 gap(const FloatBox& box, const Vec3& p) {
  Vec3 gap;
  for (int k = 0; k < 3; ++k) gap[k] = std::max({box.lower[k] - p[k], p[k] - box.upper[k], 0.0});
  return gap;
}

/// Nodes are in depth-first order: the left child of node i is i + 1.
struct AabbTree {
  struct Node {
    FloatBox box;
    std::uint32_t right = 0;  ///< inner node: its right child
    std::uint32_t first = 0;  ///< leaf: its first item, in `items`
    std::uint32_t count = 0;  ///< 0 for an inner node

    [[nodiscard]] bool leaf() const { return count > 0; }
  };
  Array<Node> nodes;           ///< empty when there are no items
  Array<std::uint32_t> items;  ///< indices of boxes, in the order of the leaves

  [[nodiscard]] const FloatBox& box(std::uint32_t node) const { return nodes[node].box; }
  [[nodiscard]] std::span<const std::uint32_t> items_of(std::uint32_t leaf) const {
    return {items.data() + nodes[leaf].first, nodes[leaf].count};
  }

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [nodes, items] = self;
    visit(nodes);
    visit(items);
  }
};

/// No node of a tree is more levels below the root: recursive functions need little stack.
inline constexpr int kDeepest = 96;

/// The most levels that a node is below the root. Cost: linear.
[[nodiscard]] int depth(const AabbTree& tree);

/// Builds a tree of the boxes that `indices` selects, with at most `leaf_size` of them per leaf, by the
/// binned surface area heuristic. Boxes are in the unit frame. The result does not depend on the number of
/// threads. Cost: O(n log n), all cores.
[[nodiscard]] AabbTree build_aabb_tree(std::span<const FloatBox> boxes, std::vector<std::uint32_t> indices,
                                       std::uint32_t leaf_size);
[[nodiscard]] AabbTree build_aabb_tree(std::span<const Box> boxes, std::vector<std::uint32_t> indices,
                                       std::uint32_t leaf_size);

/// Recomputes all boxes from those of the items; the tree keeps its structure. Cost: linear, all cores.
void refit(AabbTree& tree, std::span<const Box> boxes);
/// refit() from the boxes of the leaves in their order. Cost: linear.
void refit_leaves(AabbTree& tree, std::span<const FloatBox> leaf_boxes);

/// Items to remove from a tree and to add to it.
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
