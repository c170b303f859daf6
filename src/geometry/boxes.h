// Pairs of boxes that come near each other, and groups of boxes that overlap.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/disjoint_sets.h"

namespace sdm::core {

/// Finds pairs of nearby boxes. Reuses its memory between calls.
class Sweep {
 public:
  using Pair = std::array<std::uint32_t, 2>;

  /// Whether a pair of boxes is asked for, by their numbers.
  using Filter = std::function<bool(std::uint32_t, std::uint32_t)>;

  /// All pairs {a, b}, a < b, that pass the filter, of boxes whose distance is at most `max_distance`, in
  /// lexicographic order; valid until the next call. An empty filter lets all pass. Cost: O(n log n), plus
  /// linear in the pairs that are at most `max_distance` apart along one axis, the one along which the boxes
  /// are spread most.
  std::span<const Pair> near_pairs(std::span<const Box> boxes, double max_distance,
                                   const Filter& filter = {});

 private:
  /// Sorts the boxes by their lower ends along that axis, into order_ and sorted_, and returns it.
  int sort(std::span<const Box> boxes);

  /// Covers the rounding of differences, squares, their sum and its root.
  static constexpr double kRoundedDown = 1 - 1e-15;

  std::vector<std::uint32_t> order_;
  std::vector<Box> sorted_;
  std::vector<Pair> pairs_;

  friend double box_distance(const Box& a, const Box& b);
};

/// The distance between two boxes, rounded down; 0 if they overlap.
[[nodiscard]] double box_distance(const Box& a, const Box& b);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

namespace sdm::core {

/// Finds the connected components of boxes. Reuses its memory between calls.
class BoxGroups {
 public:
  /// Resets `groups` to one number a box, and unites those of boxes that meet. Touching boxes meet. Visits no
  /// pairs within a group that is known already, so that the cost is about O(n log n) however many pairs
  /// meet.
  void find(std::span<const Box> boxes, DisjointSets& groups);

 private:
  /// A node of a binary tree that halves the boxes at the median of their centres: order_[begin], ...,
  /// order_[end − 1].
  struct Node {
    Box box;
    std::uint32_t begin, end;
    std::uint32_t left, right;  ///< kNone for a leaf
    bool one_group;
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  void unite_within(std::uint32_t node);
  void unite_between(std::uint32_t a, std::uint32_t b);
  void unite_if_meeting(std::uint32_t i, std::uint32_t j);
  void update(Node& node);
  [[nodiscard]] std::uint32_t group_of(const Node& node) { return groups_->find(order_[node.begin]); }

  std::span<const Box> boxes_;
  DisjointSets* groups_ = nullptr;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
