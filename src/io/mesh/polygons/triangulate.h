// Triangulation of polygons.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "io/mesh/polygons/corner_tree.h"
#include "io/mesh/polygons/tournament.h"

namespace sdm::io {

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
