// Union–find.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sdm::core {

/// A partition of the numbers 0 … count − 1. Its sets, and their representatives, do not depend on the order
/// in which they are united. Cost: amortised logarithmic a call, by path halving.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) { reset(count); }

  /// Puts each number into a set of its own. Allocates nothing where there were as many before.
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  /// The representative of the set that x is in: its smallest member.
  [[nodiscard]] std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
