// Neighbour search among points.
#pragma once

#include <sdm/types.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::scenes {

/// Points sorted into the hashed cells of a uniform grid.
class SpatialHash {
 public:
  explicit SpatialHash(double cell) : cell_(cell) {}

  /// Replaces the points. Linear time; no allocation if there are no more points than before.
  void fill(std::span<const Vec3> points);

  /// Calls visit(j) for all points j within a cell size of p, and for some others; possibly several times for
  /// a point. The order is deterministic.
  template <typename Visit>
  void for_each_near(const Vec3& p, const Visit& visit) const {
    const Cell c = cell_of(p);
    for (std::int64_t x = c[0] - 1; x <= c[0] + 1; ++x)
      for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y)
        for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z) {
          const std::size_t slot = slot_of({x, y, z});
          for (std::uint32_t i = begins_[slot]; i < begins_[slot + 1]; ++i) visit(sorted_[i]);
        }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[k] / cell_));
    return cell;
  }
  // M. Teschner et al., "Optimized Spatial Hashing for Collision Detection of Deformable Objects" (2003).
  [[nodiscard]] std::size_t slot_of(const Cell& cell) const {
    const auto [x, y, z] = cell;
    const std::uint64_t hash = static_cast<std::uint64_t>(x) * 73856093u ^
                               static_cast<std::uint64_t>(y) * 19349663u ^
                               static_cast<std::uint64_t>(z) * 83492791u;
    return hash & (begins_.size() - 2);  // size() − 1 slots, a power of two
  }

  double cell_;
  std::vector<std::uint32_t> begins_;  ///< where each slot begins in sorted_
  std::vector<std::uint32_t> sorted_;
};

}  // namespace sdm::scenes
