// The minimum of many keys that change.
#pragma once

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

namespace sdm::io {

/// A tournament tree. Keys are ordered by <; positions without a key have the key `worst`.
template <typename Key>
class Tournament {
 public:
  /// Sets all keys. Cost: O(n).
  void reset(std::span<const Key> keys, const Key& worst) {
    leaves_ = std::bit_ceil(keys.size());
    best_.assign(2 * leaves_, worst);
    std::ranges::copy(keys, best_.begin() + static_cast<std::ptrdiff_t>(leaves_));
    for (std::size_t node = leaves_; node-- > 1;) update(node);
  }
  /// Sets one key. Cost: O(log n).
  void set(std::size_t place, const Key& key) {
    std::size_t node = leaves_ + place;
    best_[node] = key;
    while ((node /= 2) > 0) update(node);
  }
  /// Returns the position of a smallest key: of several, the first one from `start` on, cyclically. Cost:
  /// O(log n).
  [[nodiscard]] std::size_t least_from(std::size_t start) const {
    const auto holds_least = [&](std::size_t node) { return !(best_[1] < best_[node]); };
    std::size_t node = leaves_ + start;
    if (!holds_least(node)) {
      // Go up until a smallest key lies to the right, or to the root; then down to the first such key.
      while (node > 1 && (node % 2 != 0 || !holds_least(node + 1))) node /= 2;
      if (node > 1) ++node;
    }
    while (node < leaves_) node = 2 * node + !holds_least(2 * node);
    return node - leaves_;
  }

 private:
  void update(std::size_t node) { best_[node] = std::min(best_[2 * node], best_[2 * node + 1]); }

  std::size_t leaves_ = 0;  // a power of two; the children of node i are 2i and 2i + 1
  std::vector<Key> best_;   // the smallest key below each node
};

}  // namespace sdm::io
