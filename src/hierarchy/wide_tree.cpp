#include "hierarchy/wide_tree.h"

#include <algorithm>

namespace sdm {
namespace {

float half_area(const FloatBox& box) {
  const float x = box.hi[0] - box.lo[0], y = box.hi[1] - box.lo[1], z = box.hi[2] - box.lo[2];
  return x * y + y * z + z * x;
}

class Collapser {
 public:
  explicit Collapser(const AabbTree& tree) : tree_(tree), leaf_number_(tree.nodes.size()) {
    std::uint32_t leaves = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
      if (tree.nodes[i].leaf()) leaf_number_[i] = leaves++;
  }

  WideTree collapse() {
    add({0});
    return std::move(wide_);
  }

 private:
  // Makes a node of these binary nodes' expansion and returns its index.
  std::uint32_t add(std::vector<std::uint32_t> open) {
    while (open.size() < WideTree::kWidth) {
      std::size_t largest = open.size();
      for (std::size_t i = 0; i < open.size(); ++i)
        if (!tree_.nodes[open[i]].leaf() &&
            (largest == open.size() ||
             half_area(tree_.nodes[open[i]].box) > half_area(tree_.nodes[open[largest]].box)))
          largest = i;
      if (largest == open.size()) break;
      const std::uint32_t node = open[largest];
      open[largest] = node + 1;
      open.push_back(tree_.nodes[node].right);
    }
    const auto index = static_cast<std::uint32_t>(wide_.nodes.size());
    wide_.nodes.emplace_back();
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::uint32_t node = open[i];
      const std::uint32_t child = tree_.nodes[node].leaf() ? leaf_number_[node] | WideTree::kLeafBit
                                                           : add({node + 1, tree_.nodes[node].right});
      wide_.nodes[index].child[i] = child;
      wide_.nodes[index].source[i] = node;
    }
    wide_.nodes[index].count = static_cast<std::uint32_t>(open.size());
    return index;
  }

  const AabbTree& tree_;
  std::vector<std::uint32_t> leaf_number_;
  WideTree wide_;
};

}  // namespace

WideTree collapse(const AabbTree& tree) {
  if (tree.nodes.empty()) return {};
  WideTree wide = Collapser(tree).collapse();
  refit(wide, tree);
  return wide;
}

void refit(WideTree& wide, const AabbTree& tree) {
  for (WideTree::Node& node : wide.nodes)
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const FloatBox& box = tree.nodes[node.source[i]].box;
      for (int k = 0; k < 3; ++k) node.lo[k][i] = box.lo[k], node.hi[k][i] = box.hi[k];
    }
  for (WideTree::Node& node : wide.nodes)  // unused lanes are read by vector loads: keep them defined
    for (std::uint32_t i = node.count; i < WideTree::kWidth; ++i)
      for (int k = 0; k < 3; ++k) node.lo[k][i] = node.hi[k][i] = 0;
}

}  // namespace sdm
