// Traversals of the binary tree. No other folder depends on the layout of its nodes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "tree/aabb_tree.h"

namespace sdm::tree {

/// A node and its descendants: nodes `root` to `end` − 1. The leaves of a subtree are consecutive.
struct Subtree {
  std::uint32_t root = 0, end = 0;
};

[[nodiscard]] inline Subtree whole(const AabbTree& tree) {
  return {0, static_cast<std::uint32_t>(tree.nodes.size())};
}

/// Depth first, the left child first. enter(Subtree) returns whether to descend into a node; visit(node) is
/// called for each leaf entered, in their order.
template <class Enter, class Visit>
void traverse(const AabbTree& tree, Subtree subtree, const Enter& enter, const Visit& visit) {
  if (subtree.root == subtree.end || !enter(subtree)) return;
  const AabbTree::Node& node = tree.nodes[subtree.root];
  if (node.leaf()) return visit(subtree.root);
  traverse(tree, {subtree.root + 1, node.right}, enter, visit);
  traverse(tree, {node.right, subtree.end}, enter, visit);
}

/// Depth first, the nearer child first; the left one if both are equally near. lower_bound(box) is a lower
/// bound on the distance to anything in the box. A node is entered if within(its bound) holds at that time,
/// so the limit may shrink as leaves are visited.
template <class LowerBound, class Within, class Visit>
void traverse_nearer_first(const AabbTree& tree, const LowerBound& lower_bound, const Within& within,
                           const Visit& visit) {
  const auto descend = [&](const auto& self, std::uint32_t index) -> void {
    const AabbTree::Node& node = tree.nodes[index];
    if (node.leaf()) return visit(index);
    const std::array<std::uint32_t, 2> children{index + 1, node.right};
    const std::array bounds{lower_bound(tree.nodes[children[0]].box),
                            lower_bound(tree.nodes[children[1]].box)};
    const int nearer = bounds[0] <= bounds[1] ? 0 : 1;
    for (const int k : {nearer, 1 - nearer})
      if (within(bounds[k])) self(self, children[k]);
  };
  if (!tree.nodes.empty() && within(lower_bound(tree.nodes[0].box))) descend(descend, 0);
}

/// Two nodes of one tree, or twice the same node.
using NodePair = std::array<std::uint32_t, 2>;

/// The pairs of children to visit in place of a pair of nodes: those of the node with the larger box, or of
/// both if it is one node. Calls put(pair) for each; not for a pair of leaves.
template <class Put>
void for_each_child_pair(const AabbTree& tree, const NodePair& pair, const Put& put) {
  const auto [a, b] = pair;
  const auto children = [&](std::uint32_t i) { return NodePair{i + 1, tree.nodes[i].right}; };
  if (a == b) {
    if (tree.nodes[a].leaf()) return;
    const auto [left, right] = children(a);
    put(NodePair{left, left}), put(NodePair{right, right}), put(NodePair{left, right});
    return;
  }
  const auto size = [&](std::uint32_t i) {
    const FloatBox& box = tree.nodes[i].box;
    return box.hi[0] - box.lo[0] + box.hi[1] - box.lo[1] + box.hi[2] - box.lo[2];
  };
  if (tree.nodes[b].leaf() || (!tree.nodes[a].leaf() && size(a) >= size(b))) {
    if (tree.nodes[a].leaf()) return;
    for (const std::uint32_t child : children(a)) put(NodePair{child, b});
  } else {
    for (const std::uint32_t child : children(b)) put(NodePair{a, child});
  }
}

/// Visits the pairs of leaves of one tree, each once, and each leaf with itself. enter(pair) returns whether
/// to descend into a pair of nodes.
template <class Enter, class Visit>
void traverse_pairs(const AabbTree& tree, const NodePair& pair, const Enter& enter, const Visit& visit) {
  if (!enter(pair)) return;
  if (tree.nodes[pair[0]].leaf() && tree.nodes[pair[1]].leaf()) return visit(pair);
  for_each_child_pair(tree, pair, [&](const NodePair& below) { traverse_pairs(tree, below, enter, visit); });
}

/// The value of a subtree: summary(node), an optional, if it is set; otherwise leaf(node) or merge(left
/// value, right value).
template <class Summary, class Leaf, class Merge>
auto reduce(const AabbTree& tree, std::uint32_t index, const Summary& summary, const Leaf& leaf,
            const Merge& merge) -> typename decltype(summary(index))::value_type {
  if (const auto known = summary(index)) return *known;
  const AabbTree::Node& node = tree.nodes[index];
  if (node.leaf()) return leaf(index);
  auto left = reduce(tree, index + 1, summary, leaf, merge);
  auto right = reduce(tree, node.right, summary, leaf, merge);
  return merge(std::move(left), std::move(right));
}

/// Calls leaf(node) or inner(node, left, right) for all nodes, children before parents and the last leaf
/// first.
template <class Leaf, class Inner>
void for_each_bottom_up(const AabbTree& tree, const Leaf& leaf, const Inner& inner) {
  for (auto i = static_cast<std::uint32_t>(tree.nodes.size()); i-- > 0;) {
    const AabbTree::Node& node = tree.nodes[i];
    if (node.leaf())
      leaf(i);
    else
      inner(i, i + 1, node.right);
  }
}

/// The nodes that are leaves, in order.
[[nodiscard]] inline std::vector<std::uint32_t> leaf_nodes(const AabbTree& tree) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i)
    if (tree.nodes[i].leaf()) leaves.push_back(i);
  return leaves;
}

/// Numbers the leaves, so that a subtree is a range of them.
struct LeafOrder {
  std::vector<std::uint32_t> before;  ///< number of leaves before each node, and before the end

  explicit LeafOrder(const AabbTree& tree) : before(tree.nodes.size() + 1, 0) {
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
      before[i + 1] = before[i] + (tree.nodes[i].leaf() ? 1 : 0);
  }
  [[nodiscard]] std::uint32_t count(std::uint32_t node, std::uint32_t end) const {
    return before[end] - before[node];
  }
  [[nodiscard]] std::uint32_t count(Subtree subtree) const { return count(subtree.root, subtree.end); }
};

}  // namespace sdm::tree
