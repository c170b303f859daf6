// Values of all nodes or of a subtree from those of its leaves, and the numbers of leaves. A search that
// leaves out what is far is in visit.h.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tree/visit.h"

namespace sdm::tree {

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

/// The items of all leaves below a node, which follow each other.
[[nodiscard]] inline std::span<const std::uint32_t> items_below(const AabbTree& tree, std::uint32_t node) {
  std::uint32_t first = node, last = node;
  while (!tree.nodes[first].leaf()) ++first;
  while (!tree.nodes[last].leaf()) last = tree.nodes[last].right;
  const std::uint32_t begin = tree.nodes[first].first;
  return std::span(tree.items).subspan(begin, tree.nodes[last].first + tree.nodes[last].count - begin);
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
