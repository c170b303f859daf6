#include "tree/wide_tree.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/parallel.h"
#include "tree/fold.h"

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
          node.lo[k][i] = box.lo[k];
          node.hi[k][i] = box.hi[k];
        }
      }
    }
  });
}

namespace {

// The leaves below the nodes of a binary tree.
class LeafRanges {
 public:
  explicit LeafRanges(const AabbTree& tree) : order_(tree), end_(tree.nodes.size()) {
    for_each_bottom_up(
        tree, [&](std::uint32_t leaf) { end_[leaf] = leaf + 1; },
        [&](std::uint32_t node, std::uint32_t, std::uint32_t right) { end_[node] = end_[right]; });
  }
  [[nodiscard]] std::uint32_t first(std::uint32_t node) const { return order_.before[node]; }
  [[nodiscard]] std::uint32_t last(std::uint32_t node) const { return order_.before[end_[node]]; }

 private:
  LeafOrder order_;
  std::vector<std::uint32_t> end_;  // of each subtree
};

// Whether a child of a node, which stands for `whole`, stands for a node below that; `stands_for` has that
// node for each wide node that is a child of an earlier one.
bool is_child(const AabbTree& tree, const LeafRanges& leaves, const WideTree::Node& node, std::uint32_t i,
              std::uint32_t whole, std::span<std::uint32_t> stands_for) {
  const std::uint32_t source = node.source[i], child = node.child[i];
  if (source >= tree.nodes.size()) return false;
  const bool leaf = tree.nodes[source].leaf();
  if (leaf != WideTree::is_leaf(child) || leaf != ((node.leaves >> i & 1) != 0)) return false;
  if (leaves.first(source) < leaves.first(whole) || leaves.last(source) > leaves.last(whole)) return false;
  if (leaf) return WideTree::leaf_number(child) == leaves.first(source);
  if (child >= stands_for.size() || stands_for[child] != kNone) return false;
  stands_for[child] = source;
  return true;
}

// Whether children, which are below the node, have no leaf in common, but together all of its leaves.
bool divide(const LeafRanges& leaves, const WideTree::Node& node, std::uint32_t whole) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < node.count; ++i) {
    const std::uint32_t first = leaves.first(node.source[i]), last = leaves.last(node.source[i]);
    count += last - first;
    for (std::uint32_t j = 0; j < i; ++j)
      if (first < leaves.last(node.source[j]) && leaves.first(node.source[j]) < last) return false;
  }
  return count == leaves.last(whole) - leaves.first(whole);
}

// False for NaN.
bool is_inside(const FloatBox& box, const FloatBox& outer) {
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    inside &= outer.lo[k] <= box.lo[k];
    inside &= box.hi[k] <= outer.hi[k];
  }
  return inside;
}

// Whether a node has the boxes of the children that its own stand for, and 0 in lanes without a child.
bool has_boxes(const WideTree::Node& node, const AabbTree& tree) {
  bool same = true;
  for (std::uint32_t i = 0; i < WideTree::kWidth; ++i) {
    const FloatBox box = i < node.count ? tree.box(node.source[i]) : FloatBox{};
    for (int k = 0; k < 3; ++k) {
      same &= node.lo[k][i] == box.lo[k];
      same &= node.hi[k][i] == box.hi[k];
    }
  }
  return same;
}

}  // namespace

bool is_tree(const AabbTree& tree, std::uint32_t leaf_size, float largest_coordinate) {
  const float c = largest_coordinate;
  const FloatBox most{{-c, -c, -c}, {c, c, c}};
  std::array<std::uint32_t, kDeepest> right;  // children of the nodes above whose left subtree is not over
  std::size_t open = 0, items = 0;
  const std::size_t count = tree.nodes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const AabbTree::Node& node = tree.nodes[i];
    if (!is_inside(node.box, most)) return false;
    if (!node.leaf()) {
      if (open == right.size() || node.right <= i + 1 || node.right >= count) return false;
      if (!is_inside(tree.nodes[i + 1].box, node.box) || !is_inside(tree.box(node.right), node.box))
        return false;
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
  const LeafRanges leaves(tree);
  std::vector<std::uint32_t> stands_for(wide.nodes.size(), kNone);
  stands_for[0] = 0;
  for (std::size_t n = 0; n < wide.nodes.size(); ++n) {
    const WideTree::Node& node = wide.nodes[n];
    const std::uint32_t whole = stands_for[n];
    if (whole == kNone || node.count == 0 || node.count > WideTree::kWidth || node.leaves >> node.count != 0)
      return false;
    for (std::uint32_t i = 0; i < node.count; ++i)
      if (!is_child(tree, leaves, node, i, whole, stands_for)) return false;
    for (std::uint32_t i = node.count; i < WideTree::kWidth; ++i)
      if (node.child[i] != 0 || node.source[i] != 0) return false;
    if (!divide(leaves, node, whole) || !has_boxes(node, tree)) return false;
  }
  return true;
}

}  // namespace sdm::tree
