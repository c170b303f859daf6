// Which boxes are near each other: sweep and prune.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::core {

/// The distance of two boxes, rounded down; 0 if they overlap.
[[nodiscard]] double box_distance(const Box& a, const Box& b);

/// Finds near boxes, again and again in the same memory.
class Sweep {
 public:
  using Pair = std::array<std::uint32_t, 2>;

  /// All pairs {a, b}, a < b, of boxes whose distance is at most `reach`, in lexicographic order; valid until
  /// the next call. Cost: O(n log n) and the pairs that are near along the axis on which the boxes spread
  /// most.
  std::span<const Pair> near_pairs(std::span<const Box> boxes, double reach);

 private:
  std::vector<std::uint32_t> order_, open_;
  std::vector<Pair> pairs_;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
