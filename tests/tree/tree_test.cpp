#include <gmock/gmock.h>
#include <sdm/threads.h>

#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <random>

#include "geometry/vec.h"
#include "tree/aabb_tree.h"
#include "tree/traverse.h"
#include "tree/traverse_wide.h"
#include "tree/wide_tree.h"

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

bool contains(const tree::FloatBox& outer, const Vec3& lo, const Vec3& hi) {
  for (int k = 0; k < 3; ++k)
    if (lo[k] < outer.lo[k] || hi[k] > outer.hi[k]) return false;
  return true;
}
bool contains(const tree::FloatBox& outer, const tree::FloatBox& inner) {
  return contains(outer, {inner.lo[0], inner.lo[1], inner.lo[2]}, {inner.hi[0], inner.hi[1], inner.hi[2]});
}

// Every item in one leaf; every box holds what is below it; children after parents; leaves no larger than
// asked.
void expect_valid(const tree::AabbTree& tree, std::span<const Box> boxes, std::uint32_t leaf_size) {
  std::vector<int> seen(boxes.size(), 0);
  std::uint32_t next_item = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const tree::AabbTree::Node& node = tree.nodes[i];
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
    expect_valid(tree::build_aabb_tree(boxes, all(count), 4), boxes, 4);
  }
}

TEST(AabbTree, TakesEqualBoxesAndNone) {
  const std::vector<Box> equal(100, Box{{1, 2, 3}, {1, 2, 3}});
  expect_valid(tree::build_aabb_tree(equal, all(equal.size()), 4), equal, 4);
  EXPECT_TRUE(tree::build_aabb_tree(std::span<const Box>{}, {}, 4).nodes.empty());
}

TEST(AabbTree, DoesNotDependOnTheNumberOfThreads) {
  const auto boxes = random_boxes(30000, 2);
  const tree::AabbTree many = tree::build_aabb_tree(boxes, all(boxes.size()), 8);
  const ThreadLimit one(1);
  const tree::AabbTree single = tree::build_aabb_tree(boxes, all(boxes.size()), 8);
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
  tree::AabbTree tree = tree::build_aabb_tree(boxes, all(boxes.size()), 4);
  const tree::AabbTree before = tree;
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
  EXPECT_EQ(tree.nodes[0].box.lo, tree::FloatBox::around(whole).lo);
  EXPECT_EQ(tree.nodes[0].box.hi, tree::FloatBox::around(whole).hi);
}

TEST(WideTree, ReachesEveryLeafOnceWithItsBox) {
  for (std::size_t count : {1u, 5u, 40u, 5000u}) {
    auto boxes = random_boxes(count, 5);
    tree::AabbTree tree = tree::build_aabb_tree(boxes, all(count), 4);
    tree::WideTree wide = tree::collapse(tree);
    boxes = random_boxes(count, 6);
    refit(tree, boxes);
    refit(wide, tree);
    std::vector<std::uint32_t> leaves;  // of the binary tree
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i)
      if (tree.nodes[i].leaf()) leaves.push_back(i);
    std::vector<int> reached(leaves.size(), 0), entered(wide.nodes.size(), 0);
    for (const tree::WideTree::Node& node : wide.nodes) {
      ASSERT_GE(node.count, 1u);
      for (std::uint32_t i = 0; i < node.count; ++i) {
        const tree::FloatBox& box = tree.nodes[node.source[i]].box;
        for (int k = 0; k < 3; ++k) {
          EXPECT_EQ(node.lo[k][i], box.lo[k]);
          EXPECT_EQ(node.hi[k][i], box.hi[k]);
        }
        const bool is_leaf = tree::WideTree::is_leaf(node.child[i]);
        EXPECT_EQ((node.leaves >> i & 1) == 1, is_leaf);
        if (is_leaf) {
          const std::uint32_t leaf = tree::WideTree::leaf_number(node.child[i]);
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

double squared_distance(const tree::FloatBox& box, const Vec3& p) {
  return squared_norm(gap(box, p));
}

// Leaves whose boxes a predicate accepts, by looking at all of them.
template <class Accept>
std::vector<std::uint32_t> accepted_leaves(const tree::AabbTree& tree, const Accept& accept) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i)
    if (tree.nodes[i].leaf() && accept(tree.box(i))) leaves.push_back(i);
  return leaves;
}

struct Traversal : testing::TestWithParam<std::size_t> {
  std::vector<Box> boxes = random_boxes(GetParam(), 7);
  tree::AabbTree tree = tree::build_aabb_tree(boxes, all(boxes.size()), 3);
  std::mt19937 random{8};

  Vec3 point() {
    std::uniform_real_distribution<double> u(-1.5, 1.5);
    return {u(random), u(random), u(random)};
  }
};

INSTANTIATE_TEST_SUITE_P(Sizes, Traversal, testing::Values(0, 1, 4, 60, 3000));

TEST_P(Traversal, DepthFirstVisitsTheAcceptedLeavesInOrder) {
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = point();
    const auto accept = [&](const tree::FloatBox& box) { return squared_distance(box, p) < 0.1 * i; };
    std::vector<std::uint32_t> visited;
    traverse(
        tree, whole(tree), [&](tree::Subtree below) { return accept(tree.box(below.root)); },
        [&](std::uint32_t leaf) { visited.push_back(leaf); });
    EXPECT_EQ(visited, accepted_leaves(tree, accept));
  }
}

TEST_P(Traversal, SubtreesHoldTheLeavesThatTheirNumbersName) {
  const tree::LeafOrder order(tree);
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  EXPECT_EQ(leaves, accepted_leaves(tree, [](const tree::FloatBox&) { return true; }));
  traverse(
      tree, whole(tree),
      [&](tree::Subtree below) {
        std::vector<std::uint32_t> inside;
        traverse(
            tree, below, [](tree::Subtree) { return true; },
            [&](std::uint32_t leaf) { inside.push_back(leaf); });
        EXPECT_EQ(inside.size(), order.count(below));
        const std::uint32_t first = order.before[below.root];
        EXPECT_TRUE(std::equal(inside.begin(), inside.end(), leaves.begin() + first));
        return true;
      },
      [](std::uint32_t) {});
}

// With a limit that shrinks to the nearest box found so far, each order finds the nearest.
TEST_P(Traversal, ShrinkingLimitsLeadToTheNearestLeaf) {
  const tree::WideTree wide = tree::collapse(tree);
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  std::vector<tree::OpenChild<float>> stack;
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = point();
    const auto bound = [&](const tree::FloatBox& box) { return squared_distance(box, p); };
    double expected = std::numeric_limits<double>::infinity();
    for (const std::uint32_t leaf : leaves) expected = std::min(expected, bound(tree.box(leaf)));

    double nearer_first = std::numeric_limits<double>::infinity(), wide_first = nearer_first;
    traverse_nearer_first(
        tree, bound, [&](double least) { return least < nearer_first; },
        [&](std::uint32_t leaf) {
          EXPECT_LT(bound(tree.box(leaf)), nearer_first);
          nearer_first = bound(tree.box(leaf));
        });
    EXPECT_EQ(nearer_first, expected);
    if (leaves.empty()) continue;
    const auto within = [&](float squared) { return squared < (1 + 1e-6) * wide_first; };
    traverse_nearest_child_first(
        wide, stack,
        [&](const tree::WideTree::Node& node, float(&squared)[tree::WideTree::kWidth]) {
          squared_distances(node, tree::FloatBox::around({p, p}), squared);
          std::uint32_t near = 0;
          for (std::uint32_t c = 0; c < node.count; ++c) near |= (within(squared[c]) ? 1u : 0u) << c;
          return near;
        },
        within,
        [&](std::uint32_t leaf) { wide_first = std::min(wide_first, bound(tree.box(leaves.at(leaf)))); });
    EXPECT_EQ(wide_first, expected);
  }
}

TEST_P(Traversal, BottomUpSeesChildrenBeforeTheirParents) {
  std::vector<std::size_t> below(tree.nodes.size(), 0);  // items
  for_each_bottom_up(
      tree, [&](std::uint32_t leaf) { below[leaf] = tree.items_of(leaf).size(); },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        EXPECT_GT(below[left], 0u);
        EXPECT_GT(below[right], 0u);
        below[node] = below[left] + below[right];
      });
  EXPECT_EQ(tree.nodes.empty() ? 0 : below[0], boxes.size());
}

TEST_P(Traversal, ReduceTakesSummariesInPlaceOfSubtrees) {
  if (tree.nodes.empty()) return;
  const tree::LeafOrder order(tree);
  std::vector<std::uint32_t> end(tree.nodes.size());
  traverse(
      tree, whole(tree),
      [&](tree::Subtree below) {
        end[below.root] = below.end;
        return true;
      },
      [](std::uint32_t) {});
  for (const std::uint32_t largest : {0u, 1u, 5u, 100u, 100000u}) {
    std::size_t summaries = 0, leaves = 0;
    const std::uint32_t counted = reduce(
        tree, 0,
        [&](std::uint32_t node) -> std::optional<std::uint32_t> {
          const std::uint32_t count = order.count(node, end[node]);
          if (count > largest) return std::nullopt;
          ++summaries;
          return count;
        },
        [&](std::uint32_t) {
          ++leaves;
          return 1u;
        },
        std::plus<>());
    EXPECT_EQ(counted, leaf_nodes(tree).size());
    EXPECT_EQ(leaves, largest == 0 ? counted : 0);
    EXPECT_EQ(summaries > 0, largest > 0);
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

// Boxes towards a corner, each smaller than the one before by a little: every cut separates few of them.
TEST(AabbTree, IsNotDeepWhateverTheBoxes) {
  for (const double ratio : {0.5, 0.875, 0.93, 0.99}) {
    std::vector<Box> boxes;
    for (int axis = 0; axis < 3; ++axis)
      for (double size = 1; size > 1e-30; size *= ratio) {
        Box box{{}, {1e-30, 1e-30, 1e-30}};
        box.hi[axis] = size;
        box.lo[axis] = 0.999 * size;
        boxes.push_back(box);
      }
    const tree::AabbTree tree = tree::build_aabb_tree(boxes, all(boxes.size()), 8);
    expect_valid(tree, boxes, 8);
    EXPECT_LE(tree::depth(tree), tree::kDeepest);
  }
  const auto boxes = random_boxes(1000, 7);
  const tree::AabbTree tree = tree::build_aabb_tree(boxes, all(boxes.size()), 8);
  EXPECT_GE(tree::depth(tree), 7);  // 2⁷ leaves of 8
  EXPECT_LE(tree::depth(tree), 20);
  EXPECT_EQ(tree::depth(tree::build_aabb_tree(boxes, all(8), 8)), 0);
}

}  // namespace
}  // namespace sdm
