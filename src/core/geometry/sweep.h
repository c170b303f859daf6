// Pairs of boxes that are near each other, by sweep and prune.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::core {

/// Finds pairs of nearby boxes. Reuses its memory between calls.
class Sweep {
 public:
  using Pair = std::array<std::uint32_t, 2>;

  /// Calls visit(a, b) once for each pair of boxes whose distance is at most `reach`. Cost: O(n log n), plus
  /// linear in the pairs that are at most `reach` apart along one axis, the one along which the boxes are
  /// spread most.
  template <class Visit>
  void for_each_near(std::span<const Box> boxes, double reach, const Visit& visit);

  /// All pairs {a, b}, a < b, of boxes whose distance is at most `reach`, in lexicographic order; valid until
  /// the next call. Cost: as above.
  std::span<const Pair> near_pairs(std::span<const Box> boxes, double reach);

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

template <class Visit>
void Sweep::for_each_near(std::span<const Box> boxes, double reach, const Visit& visit) {
  if (boxes.empty()) return;
  const int axis = sort(boxes);
  const double surely_far = reach / (kRoundedDown * kRoundedDown);
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const Box box = sorted_[i];
    for (std::size_t j = i + 1; j < sorted_.size(); ++j) {
      const Box& other = sorted_[j];
      if (kRoundedDown * (other.lo[axis] - box.hi[axis]) > reach) break;
      // Most are too far apart along one of the other axes. Without branches:
      bool far = false;
      for (int k = 0; k < 3; ++k)
        far |= (other.lo[k] - box.hi[k] > surely_far) | (box.lo[k] - other.hi[k] > surely_far);
      if (!far && box_distance(box, other) <= reach) visit(order_[i], order_[j]);
    }
  }
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
