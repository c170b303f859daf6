// Pairs of boxes that are near each other, by sweep and prune.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace sdm::core {

/// Finds pairs of nearby boxes. Reuses its memory between calls.
class Sweep {
 public:
  using Pair = std::array<std::uint32_t, 2>;

  /// Which pairs are asked for, by their numbers.
  using Filter = std::function<bool(std::uint32_t, std::uint32_t)>;

  /// All pairs {a, b}, a < b, that pass the filter, of boxes whose distance is at most `reach`, in
  /// lexicographic order; valid until the next call. An empty filter lets all pass. Cost: O(n log n), plus
  /// linear in the pairs that are at most `reach` apart along one axis, the one along which the boxes are
  /// spread most.
  std::span<const Pair> near_pairs(std::span<const Box> boxes, double reach, const Filter& filter = {});

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
