// Groups of boxes that meet, directly or through others.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/disjoint_sets.h"

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
