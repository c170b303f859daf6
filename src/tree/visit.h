// Searches of one tree. A search states in its policy what it bounds, which nodes it enters, what it does
// with leaves and in which order; the functions of a policy inline.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "tree/aabb_tree.h"
#include "tree/wide_tree.h"

namespace sdm::tree {

/// A node and its descendants: nodes `root` to `end` − 1. The leaves of a subtree are consecutive.
struct Subtree {
  std::uint32_t root = 0, end = 0;
};

[[nodiscard]] inline Subtree whole(const AabbTree& tree) {
  return {0, static_cast<std::uint32_t>(tree.nodes.size())};
}

/// A policy made of functions: nodes in the order of the tree.
template <class Enter, class Leaf>
struct InOrder {
  Enter enter;
  Leaf leaf;
};
template <class Enter, class Leaf>
InOrder(Enter, Leaf) -> InOrder<Enter, Leaf>;

/// A policy made of functions: the node with the least bound first.
template <class Bound, class Enter, class Leaf>
struct NearestFirst {
  Bound bound;
  Enter enter;
  Leaf leaf;

  static bool before(float first, float second) { return first < second; }
};
template <class Bound, class Enter, class Leaf>
NearestFirst(Bound, Enter, Leaf) -> NearestFirst<Bound, Enter, Leaf>;

/// Visits the leaves of a subtree of the binary tree, depth first. Of the policy:
///
///   enter(Subtree)  whether to enter a node, asked when its turn comes
///   leaf(node)      called for each leaf that is entered
///
/// in which case the left child is first; or, for the nearer child first, the left one of two equally near,
///
///   bound(box)      a lower bound on the distance of anything in the box; also as bound(node, box)
///   enter(bound)    whether to enter, asked when its turn comes: the limit may shrink as leaves are visited
///   leaf(node)
template <class Policy>
void visit(const AabbTree& tree, Subtree below, Policy&& policy) {
  if (below.root == below.end) return;
  constexpr bool by_node = requires {
    policy.bound(below.root, tree.nodes[0].box);
  };
  if constexpr (by_node || requires { policy.bound(tree.nodes[0].box); }) {
    const auto bound_of = [&](std::uint32_t index) {
      if constexpr (by_node)
        return policy.bound(index, tree.nodes[index].box);
      else
        return policy.bound(tree.nodes[index].box);
    };
    const auto descend = [&](const auto& self, std::uint32_t index) -> void {
      const AabbTree::Node& node = tree.nodes[index];
      if (node.leaf()) return policy.leaf(index);
      const std::array<std::uint32_t, 2> children{index + 1, node.right};
      const std::array bounds{bound_of(children[0]), bound_of(children[1])};
      const int nearer = bounds[0] <= bounds[1] ? 0 : 1;
      for (const int k : {nearer, 1 - nearer})
        if (policy.enter(bounds[k])) self(self, children[k]);
    };
    if (policy.enter(bound_of(below.root))) descend(descend, below.root);
  } else {
    if (!policy.enter(below)) return;
    const AabbTree::Node& node = tree.nodes[below.root];
    if (node.leaf()) return policy.leaf(below.root);
    visit(tree, {below.root + 1, node.right}, policy);
    visit(tree, {node.right, below.end}, policy);
  }
}
template <class Policy>
void visit(const AabbTree& tree, Policy&& policy) {
  visit(tree, whole(tree), policy);
}

/// A node or leaf of the wide tree whose turn has not come, and its bound.
struct OpenNode {
  std::uint32_t child = 0;
  float bound = 0;

  static OpenNode of(const OpenNode& /*parent*/, const WideTree::Node& node, std::uint32_t slot,
                     float bound = 0) {
    return {node.child[slot], bound};
  }
  [[nodiscard]] bool leaf() const { return WideTree::is_leaf(child); }
  [[nodiscard]] std::uint32_t leaf_number() const { return WideTree::leaf_number(child); }
};

/// A node or leaf of the wide tree, the binary node that it stands for, and which child of which wide node it
/// is, where its box is; kNone for the root.
struct Place {
  std::uint32_t child = 0, source = 0, slot = kNone;

  /// Child `i` of the node with this index.
  static Place of(const WideTree::Node& node, std::uint32_t index, std::uint32_t i) {
    return {node.child[i], node.source[i], WideTree::kWidth * index + i};
  }
  [[nodiscard]] bool leaf() const { return WideTree::is_leaf(child); }
  [[nodiscard]] std::uint32_t leaf_number() const { return WideTree::leaf_number(child); }
};

/// The box of a place: from the wide tree, where a search has just read it beside those of its siblings.
[[nodiscard]] inline FloatBox box_of(const AabbTree& tree, const WideTree& wide, const Place& place) {
  if (place.slot == kNone) return tree.box(0);
  const WideTree::Node& node = wide.nodes[place.slot / WideTree::kWidth];
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = node.lower[k][place.slot % WideTree::kWidth];
    box.upper[k] = node.upper[k][place.slot % WideTree::kWidth];
  }
  return box;
}

/// Whether the search goes on after this leaf.
template <class Open, class Policy>
[[gnu::always_inline]] inline bool visit_leaf(const Open& leaf, Policy& policy) {
  if constexpr (std::is_same_v<decltype(policy.leaf(leaf)), bool>) {
    return policy.leaf(leaf);
  } else {
    policy.leaf(leaf);
    return true;
  }
}

/// Visits the leaves of the wide tree, depth first. `Open` is what is kept of a node until its turn comes, as
/// OpenNode; `stack` is scratch memory, which only grows. Of the policy:
///
///   enter(open)                whether to enter a node or leaf, asked when its turn comes
///   bound(open, node, bounds)  sets bounds of the children; returns which of them may be entered, as bits
///   leaf(open)                 called for each leaf entered; if it returns a bool, false ends the search
///   before(bound, other)       whether a child's turn comes before that of a child in a later slot
///
/// Without before(), bound(open, node) sets none, and children are taken from the last one to the first, but
/// leaves at once, when the node above them is opened. Returns whether the search was not ended. The tree is
/// not empty.
///
/// Always inlined, so that the loop is compiled for the vector instructions of its caller. The functions of
/// the policy may have those too: mark none of them to be always inlined, as the loop is compiled by itself
/// first.
template <class Open, class Policy>
[[gnu::always_inline]] inline bool visit(const WideTree& tree, std::vector<Open>& stack, Policy&& policy) {
  constexpr bool ordered = requires {
    policy.before(0.0F, 0.0F);
  };
  constexpr std::size_t kWidth = WideTree::kWidth;
  if (stack.size() < kWidth) stack.resize(kWidth);
  stack[0] = Open{};
  for (std::size_t count = 1; count > 0;) {
    Open next = stack[--count];
    if (!policy.enter(next)) continue;
    if (next.leaf()) {
      if (!visit_leaf(next, policy)) return false;
      continue;
    }
    if (count + kWidth > stack.size()) stack.resize(2 * stack.size() + kWidth);
    const WideTree::Node& node = tree.nodes[next.child];
    Open* const first = stack.data() + count;
    Open* end = first;
    if constexpr (ordered) {
      alignas(64) float bound[kWidth];
      std::uint32_t children = policy.bound(next, node, bound);
      for (; children != 0; children &= children - 1) {
        const auto slot = static_cast<std::uint32_t>(std::countr_zero(children));
        const Open child = Open::of(next, node, slot, bound[slot]);
        Open* at = end++;  // the first one on top
        for (; at != first && policy.before((at - 1)->bound, child.bound); --at) *at = *(at - 1);
        *at = child;
      }
    } else {
      for (std::uint32_t children = policy.bound(next, node); children != 0; children &= children - 1) {
        Open child = Open::of(next, node, static_cast<std::uint32_t>(std::countr_zero(children)));
        if (!child.leaf())
          *end++ = child;
        else if (policy.enter(child) && !visit_leaf(child, policy))
          return false;
      }
    }
    count += static_cast<std::size_t>(end - first);
  }
  return true;
}

}  // namespace sdm::tree
