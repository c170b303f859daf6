// Polygons to triangles.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// Cuts polygons into triangles; keeps its buffers from one to the next.
class Triangulator {
 public:
  /// Polygons of more corners would take too long: the cost is quadratic.
  static constexpr std::size_t kMaxCorners = 8192;

  /// The n − 2 triangles, as places in `points`, of a polygon with n ≥ 3 corners, in its sense of turn. They
  /// tile it if it is simple and planar, convex or not; of several cuts the shortest is taken first. Valid
  /// until the next call.
  std::span<const std::array<std::uint32_t, 3>> triangulate(std::span<const Vec3> points);

 private:
  void project(std::span<const Vec3> points);
  void classify(std::uint32_t corner);
  [[nodiscard]] double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] std::uint32_t best_ear(std::uint32_t start) const;

  struct Corner {
    std::uint32_t previous, next;
    bool convex, ear;
    double cut;  // squared length of the diagonal that cuts this corner off
  };
  std::vector<Vec2> plane_;
  std::vector<Corner> corners_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace sdm::io
