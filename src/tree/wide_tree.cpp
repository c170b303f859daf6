#include "tree/wide_tree.h"

#include <algorithm>

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
        for (int k = 0; k < 3; ++k) node.lo[k][i] = box.lo[k], node.hi[k][i] = box.hi[k];
      }
    }
  });
}

}  // namespace sdm::tree
