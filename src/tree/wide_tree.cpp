#include "tree/wide_tree.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "core/parallel.h"

namespace sdm::tree {
namespace {

class Collapser {
 public:
  explicit Collapser(const AabbTree& tree) : tree_(tree), leaf_number_(tree.nodes.size()) {
    std::uint32_t leaves = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
      if (tree.nodes[i].leaf()) leaf_number_[i] = leaves++;
  }

  WideTree collapse() {
    add({0, 0}, 1);
    nodes_.shrink_to_fit();
    return {std::move(nodes_)};
  }

 private:
  // Adds the node that one or two binary nodes expand to, and returns its index.
  std::uint32_t add(std::array<std::uint32_t, 2> nodes, std::uint32_t count) {
    std::uint32_t open[WideTree::kWidth] = {nodes[0], nodes[1]};
    float area[WideTree::kWidth];  // -1 for leaves
    const auto measure = [&](std::uint32_t i) {
      const AabbTree::Node& node = tree_.nodes[open[i]];
      area[i] = node.leaf() ? -1 : half_area(node.box);
    };
    for (std::uint32_t i = 0; i < count; ++i) measure(i);
    while (count < WideTree::kWidth) {
      const auto largest = static_cast<std::uint32_t>(std::max_element(area, area + count) - area);
      if (area[largest] < 0) break;
      const std::uint32_t node = open[largest];
      open[largest] = node + 1;
      open[count] = tree_.nodes[node].right;
      measure(largest);
      measure(count++);
    }
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].count = count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t node = open[i];
      const bool leaf = tree_.nodes[node].leaf();
      const std::uint32_t child =
          leaf ? WideTree::leaf(leaf_number_[node]) : add({node + 1, tree_.nodes[node].right}, 2);
      nodes_[index].child[i] = child;
      nodes_[index].leaves |= (leaf ? 1u : 0u) << i;
      nodes_[index].source[i] = node;
    }
    return index;
  }

  const AabbTree& tree_;
  std::vector<std::uint32_t> leaf_number_;
  std::vector<WideTree::Node> nodes_;
};

}  // namespace

WideTree collapse(const AabbTree& tree) {
  if (tree.nodes.empty()) return {};
  WideTree wide = Collapser(tree).collapse();
  refit(wide, tree);
  return wide;
}

void refit(WideTree& wide, const AabbTree& tree) {
  parallel_for(wide.nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      WideTree::Node& node = wide.nodes[n];
      for (std::uint32_t i = 0; i < node.count; ++i) {
        const FloatBox& box = tree.nodes[node.source[i]].box;
        for (int k = 0; k < 3; ++k) {
          node.lower[k][i] = box.lower[k];
          node.upper[k][i] = box.upper[k];
        }
      }
    }
  });
}

namespace {

// The leaves below a node of a binary tree.
struct LeafRange {
  std::uint32_t first = 0, last = 0;

  [[nodiscard]] std::uint32_t count() const { return last - first; }
  [[nodiscard]] bool contains(const LeafRange& other) const {
    return first <= other.first && other.last <= last;
  }
};

std::vector<LeafRange> leaf_ranges(const AabbTree& tree) {
  const std::span<const AabbTree::Node> nodes(tree.nodes);
  std::vector<LeafRange> ranges(nodes.size());
  std::uint32_t leaves = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    ranges[i].first = leaves;
    leaves += nodes[i].leaf() ? 1 : 0;
  }
  for (std::size_t i = nodes.size(); i-- > 0;)
    ranges[i].last = nodes[i].leaf() ? ranges[i].first + 1 : ranges[nodes[i].right].last;
  return ranges;
}

// Whether the children of wide nodes stand for nodes of a binary tree and divide the leaves below these. Each
// wide node, and each leaf, is a child once, and the children of a node have as many leaves as it has: so the
// leaves below a child are those of the node that it stands for, and children have none in common. Those that
// are inner nodes have fewer than their parent, so that the wide tree is not deeper than the binary one.
class WideTreeCheck {
 public:
  WideTreeCheck(const WideTree& wide, const AabbTree& tree)
      : wide_(wide.nodes),
        nodes_(tree.nodes),
        leaves_(leaf_ranges(tree)),
        whole_(wide_.size()),
        is_child_(leaves_[0].last) {
    whole_[0] = leaves_[0];
  }

  bool run() {
    for (std::size_t n = 0; n < wide_.size(); ++n)
      if (!is_node(wide_[n], whole_[n])) return false;
    return true;
  }

 private:
  // `whole` is empty unless the node is a child of an earlier one.
  bool is_node(const WideTree::Node& node, LeafRange whole) {
    if (whole.count() == 0 || node.count == 0 || node.count > WideTree::kWidth) return false;
    std::uint32_t count = 0, is_leaf = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const std::uint32_t source = node.source[i], child = node.child[i];
      if (source >= nodes_.size()) return false;
      const LeafRange below = leaves_[source];
      if (!whole.contains(below) || !is_first(child, below, whole.count())) return false;
      count += below.count();
      is_leaf |= (WideTree::is_leaf(child) ? 1u : 0u) << i;
    }
    for (std::uint32_t i = node.count; i < WideTree::kWidth; ++i)
      if (node.child[i] != 0 || node.source[i] != 0) return false;
    return count == whole.count() && node.leaves == is_leaf && has_boxes(node);
  }

  // Whether a child that stands for a node with these leaves, of so many, is a leaf, or not, as that node is,
  // and no child of another node. Inner nodes have at least two leaves.
  bool is_first(std::uint32_t child, LeafRange below, std::uint32_t of) {
    if (WideTree::is_leaf(child)) {
      if (below.count() != 1 || WideTree::leaf_number(child) != below.first) return false;
      return is_child_[below.first]++ == 0;
    }
    if (below.count() == 1 || below.count() == of) return false;
    if (child >= whole_.size() || whole_[child].count() != 0) return false;
    whole_[child] = below;
    return true;
  }

  // Whether a node has the boxes of the nodes that its children stand for, and 0 in lanes without a child.
  [[nodiscard]] bool has_boxes(const WideTree::Node& node) const {
    WideTree::Node expected;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const FloatBox& box = nodes_[node.source[i]].box;
      for (int k = 0; k < 3; ++k) {
        expected.lower[k][i] = box.lower[k];
        expected.upper[k][i] = box.upper[k];
      }
    }
    return std::memcmp(expected.lower, node.lower, sizeof node.lower) == 0 &&
           std::memcmp(expected.upper, node.upper, sizeof node.upper) == 0;
  }

  const std::span<const WideTree::Node> wide_;
  const std::span<const AabbTree::Node> nodes_;
  const std::vector<LeafRange> leaves_;  // of each binary node
  std::vector<LeafRange> whole_;         // of each wide node
  std::vector<std::uint8_t> is_child_;   // of each leaf
};

// False for NaN.
bool is_inside(const FloatBox& box, const FloatBox& outer) {
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    inside &= outer.lower[k] <= box.lower[k];
    inside &= box.upper[k] <= outer.upper[k];
  }
  return inside;
}

}  // namespace

bool is_tree(const AabbTree& tree, std::uint32_t leaf_size, float largest_coordinate) {
  const std::span<const AabbTree::Node> nodes(tree.nodes);
  const FloatBox most{{-largest_coordinate, -largest_coordinate, -largest_coordinate},
                      {largest_coordinate, largest_coordinate, largest_coordinate}};
  std::array<std::uint32_t, kDeepest> right;  // children of the nodes above whose left subtree is not over
  std::size_t open = 0, items = 0;
  const std::size_t count = nodes.size();
  if (count > 0 && !is_inside(nodes[0].box, most)) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const AabbTree::Node& node = nodes[i];
    if (!node.leaf()) {
      if (open == right.size() || node.right <= i + 1 || node.right >= count) return false;
      if (!is_inside(nodes[i + 1].box, node.box) || !is_inside(nodes[node.right].box, node.box)) return false;
      right[open++] = node.right;
      continue;
    }
    if (node.first != items || node.count > leaf_size) return false;
    items += node.count;
    if (i + 1 < count && (open == 0 || right[--open] != i + 1)) return false;
  }
  return open == 0 && items == tree.items.size() && depth(tree) <= kDeepest;
}

bool is_tree(const WideTree& wide, const AabbTree& tree) {
  if (tree.nodes.empty() || wide.nodes.empty()) return tree.nodes.empty() && wide.nodes.empty();
  return WideTreeCheck(wide, tree).run();
}

}  // namespace sdm::tree
