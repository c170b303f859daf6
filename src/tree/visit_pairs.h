// Searches of pairs of nodes, of two trees or of one tree with itself. A search states in its policy which
// pairs it enters, what it does with pairs of leaves and in which order; the functions of a policy inline.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/cancellation.h"
#include "tree/visit.h"

namespace sdm::tree {

/// The node of a pair that is replaced by its children, and which of those may be entered, as bits; 0 if the
/// pair is finished.
struct Division {
  int side = 0;
  std::uint32_t children = 0;
};

/// Visits a pair of nodes of two wide trees. `Pair` has `place`, the Place in each tree, and leaves(),
/// whether both are leaves. Of the policy:
///
///   enter(pair)              whether to enter a pair, asked when its turn comes
///   bound(pair, bounds)      chooses the node to divide and sets bounds of the pairs with its children
///   open(pair, side, bound)  keeps the pair with a child of this side until its turn
///   leaf(pair)               called for a pair of leaves that is entered
///
/// Always inlined, so that the loop is compiled for the vector instructions of its caller. The functions of
/// the policy may have those too: mark none of them to be always inlined, as the loop is compiled by itself
/// first.
template <class Pair, class Policy>
[[gnu::always_inline]] inline void visit_pair(const WideTree& a, const WideTree& b, const Pair& pair,
                                              Policy& policy) {
  if (!policy.enter(pair)) return;
  if (pair.leaves()) return policy.leaf(pair);
  alignas(64) float bound[WideTree::kWidth];
  auto [side, children] = policy.bound(pair, bound);
  if (children == 0) return;
  const std::uint32_t index = pair.place[side].child;
  const WideTree::Node& node = (side == 0 ? a : b).nodes[index];
  for (; children != 0; children &= children - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(children));
    Pair child = pair;
    child.place[side] = Place::of(node, index, slot);
    policy.open(child, side, bound[slot]);
  }
}

/// Visits pairs until next(pair) of the policy, which takes the one whose turn it is, finds none or ends the
/// search. Polls.
template <class Policy>
[[gnu::always_inline]] inline void visit_pairs(const WideTree& a, const WideTree& b, Policy& policy) {
  typename Policy::Pair pair;
  Poll due(256);
  while (policy.next(pair)) {
    due();
    visit_pair(a, b, pair, policy);
  }
}

/// Two nodes of one binary tree, or twice the same node.
using NodePair = std::array<std::uint32_t, 2>;

/// Whether both are leaves.
[[nodiscard]] inline bool leaves(const AabbTree& tree, const NodePair& pair) {
  return tree.nodes[pair[0]].leaf() && tree.nodes[pair[1]].leaf();
}

/// The pairs of children to visit in place of a pair of nodes: those of the node with the larger box, or of
/// both if it is one node. Calls put(pair) for each; not for a pair of leaves.
template <class Put>
void for_each_child_pair(const AabbTree& tree, const NodePair& pair, const Put& put) {
  const auto [a, b] = pair;
  const auto children = [&](std::uint32_t i) { return NodePair{i + 1, tree.nodes[i].right}; };
  if (a == b) {
    if (tree.nodes[a].leaf()) return;
    const auto [left, right] = children(a);
    put(NodePair{left, left});
    put(NodePair{right, right});
    put(NodePair{left, right});
    return;
  }
  const auto size = [&](std::uint32_t i) {
    const FloatBox& box = tree.nodes[i].box;
    return box.upper[0] - box.lower[0] + box.upper[1] - box.lower[1] + box.upper[2] - box.lower[2];
  };
  if (tree.nodes[b].leaf() || (!tree.nodes[a].leaf() && size(a) >= size(b))) {
    if (tree.nodes[a].leaf()) return;
    for (const std::uint32_t child : children(a)) put(NodePair{child, b});
  } else {
    for (const std::uint32_t child : children(b)) put(NodePair{a, child});
  }
}

/// Visits the pairs of leaves of one tree below a pair of nodes, each once, and each leaf with itself, depth
/// first. Of the policy: enter(pair), whether to enter a pair of nodes, and leaf(pair), as of InOrder.
template <class Policy>
void visit_pairs(const AabbTree& tree, const NodePair& pair, const Policy& policy) {
  if (!policy.enter(pair)) return;
  if (leaves(tree, pair)) return policy.leaf(pair);
  for_each_child_pair(tree, pair, [&](const NodePair& below) { visit_pairs(tree, below, policy); });
}

}  // namespace sdm::tree
