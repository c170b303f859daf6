#include "tree/aabb_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

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
    out.lo[k] = static_cast<float>(box.lo[k]);
    out.hi[k] = static_cast<float>(box.hi[k]);
    if (out.lo[k] > box.lo[k]) out.lo[k] = next(out.lo[k], false);
    if (out.hi[k] < box.hi[k]) out.hi[k] = next(out.hi[k], true);
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

}  // namespace sdm::tree
