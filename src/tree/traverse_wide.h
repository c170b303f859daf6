// Traversal of the wide tree.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "tree/wide_tree.h"

namespace sdm::tree {

/// A child of a wide node that is still to be visited.
template <class Distance>
struct OpenChild {
  std::uint32_t child;
  Distance squared;  ///< distance to its box
};

/// Depth first, the nearest child first. near(node, squared) sets the squared distances of a node's children
/// and returns a bit mask of those within reach; within(squared) is tested again before a child is visited;
/// visit(leaf) receives the number of a leaf. `stack` is scratch memory.
///
/// Always inlined, so that the loop is compiled for the vector instructions of its caller.
template <class Distance, class Near, class Within, class Visit>
[[gnu::always_inline]] inline void traverse_nearest_child_first(const WideTree& tree,
                                                                std::vector<OpenChild<Distance>>& stack,
                                                                const Near& near, const Within& within,
                                                                const Visit& visit) {
  stack.assign(1, {0, 0});
  while (!stack.empty()) {
    const OpenChild<Distance> entry = stack.back();
    stack.pop_back();
    if (!within(entry.squared)) continue;
    if (WideTree::is_leaf(entry.child)) {
      visit(WideTree::leaf_number(entry.child));
      continue;
    }
    const WideTree::Node& node = tree.nodes[entry.child];
    alignas(64) Distance squared[WideTree::kWidth];
    std::uint32_t open = near(node, squared);
    const auto base = static_cast<std::ptrdiff_t>(stack.size());
    for (; open != 0; open &= open - 1) {  // the nearest on top
      const int slot = std::countr_zero(open);
      const OpenChild<Distance> child{node.child[slot], squared[slot]};
      auto at = stack.end();
      while (at != stack.begin() + base && (at - 1)->squared < child.squared) --at;
      stack.insert(at, child);
    }
  }
}

}  // namespace sdm::tree
