#include <gmock/gmock.h>
#include <sdm/execution.h>

#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "geometry/unit_frame.h"
#include "geometry/vec.h"
#include "support/arrays.h"  // IWYU pragma: keep, for EXPECT_EQ
#include "tree/aabb_tree.h"
#include "tree/fold.h"
#include "tree/visit.h"
#include "tree/visit_pairs.h"
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
    if (lo[k] < outer.lower[k] || hi[k] > outer.upper[k]) return false;
  return true;
}
bool contains(const tree::FloatBox& outer, const tree::FloatBox& inner) {
  return contains(outer, {inner.lower[0], inner.lower[1], inner.lower[2]},
                  {inner.upper[0], inner.upper[1], inner.upper[2]});
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
        EXPECT_TRUE(contains(node.box, boxes[tree.items[k]].lower, boxes[tree.items[k]].upper));
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
    EXPECT_EQ(many.nodes[i].box.lower, single.nodes[i].box.lower);
    EXPECT_EQ(many.nodes[i].box.upper, single.nodes[i].box.upper);
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
    EXPECT_EQ(tree.nodes[i].box.lower, before.nodes[i].box.lower);
    EXPECT_EQ(tree.nodes[i].box.upper, before.nodes[i].box.upper);
  }
  const auto moved = random_boxes(5000, 4);
  refit(tree, moved);
  expect_valid(tree, moved, 4);
  Box whole;
  for (const Box& box : moved) extend(whole, box);
  EXPECT_EQ(tree.nodes[0].box.lower, tree::FloatBox::around(whole).lower);
  EXPECT_EQ(tree.nodes[0].box.upper, tree::FloatBox::around(whole).upper);
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
          EXPECT_EQ(node.lower[k][i], box.lower[k]);
          EXPECT_EQ(node.upper[k][i], box.upper[k]);
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
    visit(tree, tree::InOrder{[&](tree::Subtree below) { return accept(tree.box(below.root)); },
                              [&](std::uint32_t leaf) { visited.push_back(leaf); }});
    EXPECT_EQ(visited, accepted_leaves(tree, accept));
  }
}

TEST_P(Traversal, SubtreesHoldTheLeavesThatTheirNumbersName) {
  const tree::LeafOrder order(tree);
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  EXPECT_EQ(leaves, accepted_leaves(tree, [](const tree::FloatBox&) { return true; }));
  const auto enter = [&](tree::Subtree below) {
    std::vector<std::uint32_t> inside;
    visit(tree, below,
          tree::InOrder{[](tree::Subtree) { return true; },
                        [&](std::uint32_t leaf) { inside.push_back(leaf); }});
    EXPECT_EQ(inside.size(), order.count(below));
    const std::uint32_t first = order.before[below.root];
    EXPECT_TRUE(std::equal(inside.begin(), inside.end(), leaves.begin() + first));
    return true;
  };
  visit(tree, tree::InOrder{enter, [](std::uint32_t) {}});
}

// With a limit that shrinks to the nearest box found so far, each order finds the nearest.
TEST_P(Traversal, ShrinkingLimitsLeadToTheNearestLeaf) {
  const tree::WideTree wide = tree::collapse(tree);
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  std::vector<tree::OpenNode> stack;
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = point();
    const auto bound = [&](const tree::FloatBox& box) { return squared_distance(box, p); };
    double expected = std::numeric_limits<double>::infinity();
    for (const std::uint32_t leaf : leaves) expected = std::min(expected, bound(tree.box(leaf)));

    double nearer_first = std::numeric_limits<double>::infinity(), wide_first = nearer_first;
    const auto enter = [&](double least) { return least < nearer_first; };
    const auto visit_leaf = [&](std::uint32_t leaf) {
      EXPECT_LT(bound(tree.box(leaf)), nearer_first);
      nearer_first = bound(tree.box(leaf));
    };
    visit(tree, tree::NearestFirst{bound, enter, visit_leaf});
    EXPECT_EQ(nearer_first, expected);
    if (leaves.empty()) continue;
    const auto within = [&](float squared) { return squared < (1 + 1e-6) * wide_first; };
    const auto bound_children = [&](const tree::OpenNode&, const tree::WideTree::Node& node,
                                    float(&squared)[tree::WideTree::kWidth]) {
      squared_distances(node, tree::FloatBox::around({p, p}), squared);
      std::uint32_t near = 0;
      for (std::uint32_t c = 0; c < node.count; ++c) near |= (within(squared[c]) ? 1u : 0u) << c;
      return near;
    };
    const auto enter_open = [&](const tree::OpenNode& open) { return within(open.bound); };
    const auto visit_open = [&](const tree::OpenNode& leaf) {
      wide_first = std::min(wide_first, bound(tree.box(leaves.at(leaf.leaf_number()))));
    };
    EXPECT_TRUE(visit(wide, stack, tree::NearestFirst{bound_children, enter_open, visit_open}));
    EXPECT_EQ(wide_first, expected);
  }
}

// A policy of the wide tree without an order, for the leaves whose boxes overlap one.
struct OverlappingLeaves {
  const tree::FloatBox& box;
  std::vector<std::uint32_t>& leaves;
  std::size_t most = std::numeric_limits<std::size_t>::max();

  static bool enter(const tree::OpenNode&) { return true; }
  std::uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node) const {
    float squared[tree::WideTree::kWidth];
    squared_distances(node, box, squared);
    std::uint32_t children = 0;
    for (std::uint32_t c = 0; c < node.count; ++c) children |= (squared[c] == 0 ? 1u : 0u) << c;
    return children;
  }
  [[nodiscard]] bool leaf(const tree::OpenNode& open) const {
    leaves.push_back(open.leaf_number());
    return leaves.size() < most;
  }
};

TEST_P(Traversal, WideSearchesWithoutAnOrderFindTheAcceptedLeavesUntilOneEndsThem) {
  const tree::WideTree wide = tree::collapse(tree);
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  if (leaves.empty()) return;
  std::vector<tree::OpenNode> stack;
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = point(), q = point();
    Box around;
    extend(around, p);
    extend(around, q);
    const tree::FloatBox box = tree::FloatBox::around(around);
    std::vector<std::uint32_t> found, expected;
    EXPECT_TRUE(visit(wide, stack, OverlappingLeaves{box, found}));
    for (std::uint32_t leaf = 0; leaf < leaves.size(); ++leaf)
      if (squared_norm(gap(tree.box(leaves[leaf]), box)) == 0) expected.push_back(leaf);
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
    const std::vector<std::uint32_t> all_found = std::exchange(found, {});
    if (all_found.size() < 2) continue;
    EXPECT_FALSE(visit(wide, stack, OverlappingLeaves{box, found, 2}));
    EXPECT_THAT(found, testing::ElementsAre(all_found[0], all_found[1]));
  }
}

// The same pairs by looking at all of them.
TEST_P(Traversal, PairsOfOneTreeAreVisitedOnceEach) {
  if (tree.nodes.empty() || GetParam() > 100) return;
  const auto overlap = [&](const tree::NodePair& pair) {
    return squared_norm(gap(tree.box(pair[0]), tree.box(pair[1]))) == 0;
  };
  std::vector<tree::NodePair> visited, expected;
  visit_pairs(tree, {0, 0}, tree::InOrder{overlap, [&](tree::NodePair pair) {
                                            std::ranges::sort(pair);
                                            visited.push_back(pair);
                                          }});
  const std::vector<std::uint32_t> leaves = leaf_nodes(tree);
  for (std::size_t i = 0; i < leaves.size(); ++i)
    for (std::size_t j = i; j < leaves.size(); ++j)
      if (overlap({leaves[i], leaves[j]})) expected.push_back({leaves[i], leaves[j]});
  EXPECT_THAT(visited, testing::UnorderedElementsAreArray(expected));
}

// The policy of a search for the pairs of leaves of two wide trees whose boxes overlap.
struct OverlappingPairs {
  struct Pair {
    std::array<tree::Place, 2> place;
    [[nodiscard]] bool leaves() const { return place[0].leaf() && place[1].leaf(); }
  };
  std::array<const tree::AabbTree*, 2> binary;
  std::array<const tree::WideTree*, 2> wide;
  std::vector<Pair> stack{Pair{}};
  std::vector<std::array<std::uint32_t, 2>> found{};

  bool next(Pair& pair) {
    if (stack.empty()) return false;
    pair = stack.back();
    stack.pop_back();
    return true;
  }
  static bool enter(const Pair&) { return true; }
  [[nodiscard]] tree::Division bound(const Pair& pair, float (&squared)[tree::WideTree::kWidth]) const {
    const int side = pair.place[0].leaf() || (!pair.place[1].leaf() && pair.place[1].child % 2 == 0) ? 1 : 0;
    const tree::WideTree::Node& node = wide[side]->nodes[pair.place[side].child];
    squared_distances(node, binary[1 - side]->box(pair.place[1 - side].source), squared);
    std::uint32_t children = 0;
    for (std::uint32_t c = 0; c < node.count; ++c) children |= (squared[c] == 0 ? 1u : 0u) << c;
    return {side, children};
  }
  void open(const Pair& pair, int /*side*/, float squared) {
    EXPECT_EQ(squared, 0);
    stack.push_back(pair);
  }
  void leaf(const Pair& pair) { found.push_back({pair.place[0].leaf_number(), pair.place[1].leaf_number()}); }
};

TEST_P(Traversal, PairsOfTwoTreesAreVisitedOnceEach) {
  const std::vector<Box> others = random_boxes(70, 9);
  const tree::AabbTree other = tree::build_aabb_tree(others, all(others.size()), 2);
  if (tree.nodes.empty()) return;
  const tree::WideTree wide = tree::collapse(tree), other_wide = tree::collapse(other);
  OverlappingPairs search{{&tree, &other}, {&wide, &other_wide}};
  visit_pairs(wide, other_wide, search);
  std::vector<std::array<std::uint32_t, 2>> expected;
  const std::vector<std::uint32_t> leaves1 = leaf_nodes(tree), leaves2 = leaf_nodes(other);
  for (std::uint32_t i = 0; i < leaves1.size(); ++i)
    for (std::uint32_t j = 0; j < leaves2.size(); ++j)
      if (squared_norm(gap(tree.box(leaves1[i]), other.box(leaves2[j]))) == 0) expected.push_back({i, j});
  EXPECT_THAT(search.found, testing::UnorderedElementsAreArray(expected));
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
  const auto set_end = [&](tree::Subtree below) {
    end[below.root] = below.end;
    return true;
  };
  visit(tree, tree::InOrder{set_end, [](std::uint32_t) {}});
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
    for (const Vec3& corner : {box.lower, box.upper})
      for (double x : frame.to_unit(corner)) EXPECT_LE(std::abs(x), 1);
    EXPECT_GT(std::abs(frame.to_unit(box.upper)[0]), 0.25);
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
        box.upper[axis] = size;
        box.lower[axis] = 0.999 * size;
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
