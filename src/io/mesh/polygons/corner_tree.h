// Finds corners of a polygon that lie in a triangle.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// A set of corners of a planar polygon, in a balanced tree of boxes.
class CornerTree {
 public:
  /// Starts with an empty set. `points` must outlive the set. Cost: O(n log n).
  void reset(std::span<const Vec2> points);
  /// Adds a corner to the set or removes it. Cost: O(log n).
  void set(std::uint32_t corner, bool present);

  /// Returns whether `test` holds for any corner of the set that may lie in the counter-clockwise triangle or
  /// on its boundary. Corners that are vertices of the triangle are not tested.
  template <typename Test>
  [[nodiscard]] bool any_in(const std::array<Vec2, 3>& triangle, const Test& test) const {
    return any_in(1, triangle, test);
  }

 private:
  struct Box {
    Vec2 low{kInfinity, kInfinity};
    Vec2 high{-kInfinity, -kInfinity};

    [[nodiscard]] bool operator==(const Box&) const = default;
  };
  [[nodiscard]] static bool may_overlap(const Box& box, const std::array<Vec2, 3>& triangle);

  // The recursion is as deep as the tree: at most 32.
  template <typename Test>
  bool any_in(std::size_t node, const std::array<Vec2, 3>& triangle, const Test& test) const {
    if (!may_overlap(boxes_[node], triangle)) return false;
    if (node >= leaves_) return test(corner_of_leaf_[node - leaves_]);
    return any_in(2 * node, triangle, test) || any_in(2 * node + 1, triangle, test);
  }

  std::span<const Vec2> points_;
  std::size_t leaves_ = 0;  // a power of two; the children of node i are 2i and 2i + 1
  std::vector<Box> boxes_;  // of the corners present below each node
  std::vector<std::uint32_t> corner_of_leaf_, leaf_of_corner_;
};

}  // namespace sdm::io
