// Triangulation of polygons.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
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

/// Triangulates polygons by clipping ears, shortest diagonal first. Reuses its memory between polygons.
class Triangulator {
 public:
  /// Returns the n − 2 triangles of a polygon with n ≥ 3 finite corners, as indices into `points`, with the
  /// polygon's orientation. They tile it if it is simple and planar; corners may coincide, as at bridges to
  /// holes. For any other polygon, the n − 2 triangles still have its boundary. Valid until the next call.
  /// Cost: about O(n log n); in the worst case, where the polygon overlaps itself everywhere, O(n²).
  std::span<const std::array<std::uint32_t, 3>> triangulate(std::span<const Vec3> points);

 private:
  struct Corner {
    std::uint32_t previous, next;
    bool convex, ear;
    double cut;  // squared length of the diagonal that cuts off this corner
  };
  /// The order of clipping: ears first, then by length of the diagonal.
  enum class Kind { ear, other, clipped };
  using Rank = std::pair<Kind, double>;

  void project();
  [[nodiscard]] double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] bool blocks(std::uint32_t p, std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] bool is_ear(std::uint32_t corner) const;
  [[nodiscard]] Rank rank(std::uint32_t corner) const;
  [[nodiscard]] std::uint32_t best_ear(std::uint32_t start) const;
  void link_corners();
  void clip(std::uint32_t ear);

  std::span<const Vec3> points_;
  std::vector<Vec2> plane_;
  std::vector<Corner> corners_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  // An index of large polygons: the ranks of all corners, and the remaining corners that are not convex.
  bool indexed_ = false;
  Tournament<Rank> ranks_;
  CornerTree reflex_;
};

}  // namespace sdm::io
