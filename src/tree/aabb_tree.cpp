#include "tree/aabb_tree.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "geometry/vec.h"
#include "tree/fold.h"

namespace sdm::tree {
namespace {

constexpr std::size_t kGrain = 2048;

std::vector<FloatBox> to_float(std::span<const Box> boxes) {
  std::vector<FloatBox> rounded(boxes.size());
  parallel_for(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) rounded[i] = FloatBox::around(boxes[i]);
  });
  return rounded;
}

// The next float above or below x: std::nextafter for finite x, inlined. For floats of one sign, the order of
// the bit patterns as integers is that of the magnitudes.
float next(float x, bool above) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return std::bit_cast<float>(bits + ((bits < 0) == above ? -1 : 1));
}

}  // namespace

FloatBox FloatBox::around(const Box& box) {
  FloatBox out;
  for (int k = 0; k < 3; ++k) {
    out.lower[k] = static_cast<float>(box.lower[k]);
    out.upper[k] = static_cast<float>(box.upper[k]);
    if (out.lower[k] > box.lower[k]) out.lower[k] = next(out.lower[k], false);
    if (out.upper[k] < box.upper[k]) out.upper[k] = next(out.upper[k], true);
  }
  return out;
}

AabbTree build_aabb_tree(std::span<const Box> boxes, std::vector<std::uint32_t> indices,
                         std::uint32_t leaf_size) {
  return build_aabb_tree(to_float(boxes), std::move(indices), leaf_size);
}

int depth(const AabbTree& tree) {
  int deepest = 0;
  std::vector<int> level(tree.nodes.size(), 0);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    deepest = std::max(deepest, level[i]);
    if (!tree.nodes[i].leaf()) level[i + 1] = level[tree.nodes[i].right] = level[i] + 1;
  }
  return deepest;
}

void refit_leaves(AabbTree& tree, std::span<const FloatBox> leaf_boxes) {
  auto& nodes = tree.nodes;
  std::size_t leaf = leaf_boxes.size();
  for_each_bottom_up(
      tree, [&](std::uint32_t i) { nodes[i].box = leaf_boxes[--leaf]; },
      [&](std::uint32_t i, std::uint32_t left, std::uint32_t right) {
        nodes[i].box = unite(nodes[left].box, nodes[right].box);
      });
}

void refit(AabbTree& tree, std::span<const Box> boxes) {
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  std::vector<FloatBox> leaf_boxes(leaves.size());
  parallel_for(leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      Box box;
      for (const std::uint32_t item : tree.items_of(leaves[leaf])) extend(box, boxes[item]);
      leaf_boxes[leaf] = FloatBox::around(box);
    }
  });
  refit_leaves(tree, leaf_boxes);
}

namespace {

class TreeEditor {
 public:
  TreeEditor(const AabbTree& tree, const TreeEdit& edit, std::uint32_t leaf_size)
      : tree_(tree), edit_(edit), leaf_size_(leaf_size), used_(tree.nodes.size(), 0) {}

  AabbTree run() {
    for (const std::uint32_t item : edit_.added) additions_.emplace_back(leaf_for(edit_.box_of(item)), item);
    std::ranges::stable_sort(additions_, {}, &std::pair<std::uint32_t, std::uint32_t>::first);
    for_each_bottom_up(
        tree_, [&](std::uint32_t leaf) { used_[leaf] = is_used(leaf); },
        [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
          used_[node] = used_[left] || used_[right];
        });
    nodes_.reserve(tree_.nodes.size() + 2 * edit_.added.size());
    items_.reserve(tree_.items.size() + edit_.added.size());
    copy(0);
    return {std::move(nodes_), std::move(items_)};
  }

 private:
  [[nodiscard]] std::uint32_t leaf_for(const FloatBox& box) const {
    std::uint32_t index = 0;
    while (!tree_.nodes[index].leaf()) {
      const std::array<std::uint32_t, 2> children{index + 1, tree_.nodes[index].right};
      std::array<float, 2> growth{};
      for (int k = 0; k < 2; ++k)
        growth[k] = half_area(unite(tree_.box(children[k]), box)) - half_area(tree_.box(children[k]));
      index = children[growth[1] < growth[0] ? 1 : 0];
    }
    return index;
  }

  [[nodiscard]] auto added_to(std::uint32_t leaf) const {
    return std::ranges::equal_range(additions_, leaf, {}, &std::pair<std::uint32_t, std::uint32_t>::first);
  }

  [[nodiscard]] bool is_used(std::uint32_t leaf) const {
    return !added_to(leaf).empty() || std::ranges::any_of(tree_.items_of(leaf), [&](std::uint32_t item) {
      return edit_.kept[item] != 0;
    });
  }

  void copy(std::uint32_t index) {
    const AabbTree::Node& node = tree_.nodes[index];
    if (node.leaf()) return copy_leaf(index);
    if (!used_[index + 1]) return copy(node.right);
    if (!used_[node.right]) return copy(index + 1);
    const std::size_t place = nodes_.size();
    nodes_.push_back(node);
    copy(index + 1);
    nodes_[place].right = static_cast<std::uint32_t>(nodes_.size());
    copy(node.right);
  }

  void copy_leaf(std::uint32_t leaf) {
    std::vector<std::uint32_t> items;
    for (const std::uint32_t item : tree_.items_of(leaf))
      if (edit_.kept[item]) items.push_back(item);
    for (const auto& addition : added_to(leaf)) items.push_back(addition.second);
    const auto first_item = static_cast<std::uint32_t>(items_.size());
    if (items.size() <= leaf_size_) {
      AabbTree::Node& node = nodes_.emplace_back(tree_.nodes[leaf]);
      node.first = first_item;
      node.count = static_cast<std::uint32_t>(items.size());
      items_.insert(items_.end(), items.begin(), items.end());
      return;
    }
    std::vector<FloatBox> boxes;
    for (const std::uint32_t item : items) boxes.push_back(edit_.box_of(item));
    std::vector<std::uint32_t> all(items.size());
    std::iota(all.begin(), all.end(), 0u);
    const AabbTree part = build_aabb_tree(std::span<const FloatBox>(boxes), std::move(all), leaf_size_);
    const auto first_node = static_cast<std::uint32_t>(nodes_.size());
    for (AabbTree::Node node : part.nodes) {
      if (node.leaf())
        node.first += first_item;
      else
        node.right += first_node;
      nodes_.push_back(node);
    }
    for (const std::uint32_t i : part.items) items_.push_back(items[i]);
  }

  const AabbTree& tree_;
  const TreeEdit& edit_;
  const std::uint32_t leaf_size_;
  std::vector<std::uint8_t> used_;                                  ///< of each node: has an item now
  std::vector<std::pair<std::uint32_t, std::uint32_t>> additions_;  ///< leaf and item, by leaf
  std::vector<AabbTree::Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace

AabbTree edit_tree(const AabbTree& tree, const TreeEdit& edit, std::uint32_t leaf_size) {
  return TreeEditor(tree, edit, leaf_size).run();
}

void append(AabbTree& forest, const AabbTree& tree) {
  const auto nodes = static_cast<std::uint32_t>(forest.nodes.size()),
             first = static_cast<std::uint32_t>(forest.items.size());
  for (AabbTree::Node node : tree.nodes) {
    if (node.leaf())
      node.first += first;
    else
      node.right += nodes;
    forest.nodes.push_back(node);
  }
  forest.items.append(tree.items.begin(), tree.items.end());
}

}  // namespace sdm::tree
