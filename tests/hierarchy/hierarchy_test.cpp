#include <gmock/gmock.h>
#include <sdm/threads.h>

#include <numeric>
#include <random>

#include "core/vec.h"
#include "hierarchy/aabb_tree.h"
#include "hierarchy/wide_tree.h"

namespace sdm {
namespace {

std::vector<Box> random_boxes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    const Vec3 p{u(random), u(random), u(random)};
    extend(box, p);
    extend(box, p + 0.05 * Vec3{u(random), u(random), u(random)});
  }
  return boxes;
}

std::vector<std::uint32_t> all(std::size_t count) {
  std::vector<std::uint32_t> indices(count);
  std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

bool contains(const hierarchy::FloatBox& outer, const Vec3& lo, const Vec3& hi) {
  for (int k = 0; k < 3; ++k)
    if (lo[k] < outer.lo[k] || hi[k] > outer.hi[k]) return false;
  return true;
}
bool contains(const hierarchy::FloatBox& outer, const hierarchy::FloatBox& inner) {
  return contains(outer, {inner.lo[0], inner.lo[1], inner.lo[2]}, {inner.hi[0], inner.hi[1], inner.hi[2]});
}

// Every item in one leaf; every box holds what is below it; children after parents; leaves no larger than
// asked.
void expect_valid(const hierarchy::AabbTree& tree, std::span<const Box> boxes, std::uint32_t leaf_size) {
  std::vector<int> seen(boxes.size(), 0);
  std::uint32_t next_item = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const hierarchy::AabbTree::Node& node = tree.nodes[i];
    if (node.leaf()) {
      EXPECT_LE(node.count, leaf_size);
      EXPECT_EQ(node.first, next_item) << "leaves follow the order of the items";
      next_item += node.count;
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        ++seen[tree.items[k]];
        EXPECT_TRUE(contains(node.box, boxes[tree.items[k]].lo, boxes[tree.items[k]].hi));
      }
    } else {
      ASSERT_GT(node.right, i + 1);
      ASSERT_LT(node.right, tree.nodes.size());
      EXPECT_TRUE(contains(node.box, tree.nodes[i + 1].box));
      EXPECT_TRUE(contains(node.box, tree.nodes[node.right].box));
    }
  }
  EXPECT_THAT(seen, testing::Each(1));
}

TEST(AabbTree, HoldsEveryItemOnceInBoxesThatContainIt) {
  for (std::size_t count : {1u, 2u, 9u, 1000u, 20000u}) {
    const auto boxes = random_boxes(count, 1);
    expect_valid(hierarchy::build_aabb_tree(boxes, all(count), 4), boxes, 4);
  }
}

TEST(AabbTree, TakesEqualBoxesAndNone) {
  const std::vector<Box> equal(100, Box{{1, 2, 3}, {1, 2, 3}});
  expect_valid(hierarchy::build_aabb_tree(equal, all(equal.size()), 4), equal, 4);
  EXPECT_TRUE(hierarchy::build_aabb_tree(std::span<const Box>{}, {}, 4).nodes.empty());
}

TEST(AabbTree, DoesNotDependOnTheNumberOfThreads) {
  const auto boxes = random_boxes(30000, 2);
  const hierarchy::AabbTree many = hierarchy::build_aabb_tree(boxes, all(boxes.size()), 8);
  const ThreadLimit one(1);
  const hierarchy::AabbTree single = hierarchy::build_aabb_tree(boxes, all(boxes.size()), 8);
  EXPECT_EQ(many.items, single.items);
  ASSERT_EQ(many.nodes.size(), single.nodes.size());
  for (std::size_t i = 0; i < many.nodes.size(); ++i) {
    EXPECT_EQ(many.nodes[i].box.lo, single.nodes[i].box.lo);
    EXPECT_EQ(many.nodes[i].box.hi, single.nodes[i].box.hi);
    EXPECT_EQ(many.nodes[i].right, single.nodes[i].right);
    EXPECT_EQ(many.nodes[i].first, single.nodes[i].first);
    EXPECT_EQ(many.nodes[i].count, single.nodes[i].count);
  }
}

TEST(AabbTree, RefitGivesTheSmallestBoxesOfMovedItems) {
  auto boxes = random_boxes(5000, 3);
  hierarchy::AabbTree tree = hierarchy::build_aabb_tree(boxes, all(boxes.size()), 4);
  const hierarchy::AabbTree before = tree;
  refit(tree, boxes);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    EXPECT_EQ(tree.nodes[i].box.lo, before.nodes[i].box.lo);
    EXPECT_EQ(tree.nodes[i].box.hi, before.nodes[i].box.hi);
  }
  const auto moved = random_boxes(5000, 4);
  refit(tree, moved);
  expect_valid(tree, moved, 4);
  Box whole;
  for (const Box& box : moved) extend(whole, box);
  EXPECT_EQ(tree.nodes[0].box.lo, hierarchy::FloatBox::around(whole).lo);
  EXPECT_EQ(tree.nodes[0].box.hi, hierarchy::FloatBox::around(whole).hi);
}

TEST(WideTree, ReachesEveryLeafOnceWithItsBox) {
  for (std::size_t count : {1u, 5u, 40u, 5000u}) {
    auto boxes = random_boxes(count, 5);
    hierarchy::AabbTree tree = hierarchy::build_aabb_tree(boxes, all(count), 4);
    hierarchy::WideTree wide = hierarchy::collapse(tree);
    boxes = random_boxes(count, 6);
    refit(tree, boxes);
    refit(wide, tree);
    std::vector<std::uint32_t> leaves;  // of the binary tree
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i)
      if (tree.nodes[i].leaf()) leaves.push_back(i);
    std::vector<int> reached(leaves.size(), 0), entered(wide.nodes.size(), 0);
    for (const hierarchy::WideTree::Node& node : wide.nodes) {
      ASSERT_GE(node.count, 1u);
      for (std::uint32_t i = 0; i < node.count; ++i) {
        const hierarchy::FloatBox& box = tree.nodes[node.source[i]].box;
        for (int k = 0; k < 3; ++k) {
          EXPECT_EQ(node.lo[k][i], box.lo[k]);
          EXPECT_EQ(node.hi[k][i], box.hi[k]);
        }
        if (node.child[i] & hierarchy::WideTree::kLeafBit) {
          const std::uint32_t leaf = node.child[i] & ~WideTree::kLeafBit;
          EXPECT_EQ(leaves.at(leaf), node.source[i]);
          ++reached[leaf];
        } else {
          ++entered.at(node.child[i]);
        }
      }
    }
    EXPECT_THAT(reached, testing::Each(1));
    EXPECT_EQ(entered[0], 0);
    EXPECT_TRUE(std::all_of(entered.begin() + 1, entered.end(), [](int n) { return n == 1; }));
  }
}

TEST(UnitFrame, BringsAnySizeIntoTheCubeByAPowerOfTwo) {
  for (double size : {1e-300, 1e-3, 1.0, 3.7e5, 1e149}) {
    const Box box{{size, size, size}, {3 * size, 2 * size, 2.5 * size}};
    const UnitFrame frame = UnitFrame::of(box);
    int exponent = 0;
    EXPECT_EQ(std::frexp(frame.scale, &exponent), 0.5);
    for (const Vec3& corner : {box.lo, box.hi})
      for (double x : frame.to_unit(corner)) EXPECT_LE(std::abs(x), 1);
    EXPECT_GT(std::abs(frame.to_unit(box.hi)[0]), 0.25);
  }
  EXPECT_EQ(UnitFrame::of({{5, 5, 5}, {5, 5, 5}}).to_unit({5, 5, 5}), (Vec3{0, 0, 0}));
}

}  // namespace
}  // namespace sdm
