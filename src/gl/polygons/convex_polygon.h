// Convex polygons in an image, and clipping them by half-planes.
#pragma once

#include <sdm/types.h>

#include <array>
#include <span>

#include "geometry/clip.h"

namespace sdm::gl {

/// The half-plane value + gradient·(u, v) ≥ 0.
struct HalfPlane {
  double value = 0;
  Vec2 gradient{};

  [[nodiscard]] double operator()(const Vec2& uv) const { return value + dot(gradient, uv); }
};

/// Corners in order around the polygon; none for the empty polygon.
class ConvexPolygon {
 public:
  /// A cut adds at most one corner, so this fits seven of a domain's outline and five walls of a region, or
  /// the six sides of its box.
  static constexpr int kMaxCorners = 13;

  ConvexPolygon() = default;
  static ConvexPolygon rectangle(const Vec2& lo, const Vec2& hi) {
    ConvexPolygon p;
    p.corners_ = {lo, {hi[0], lo[1]}, hi, {lo[0], hi[1]}};
    p.count_ = 4;
    return p;
  }

  [[nodiscard]] std::span<const Vec2> corners() const { return {corners_.data(), count_}; }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// Keeps the part in the half-plane. Corners beyond kMaxCorners, which only rounding could produce, are
  /// dropped.
  void cut(const HalfPlane& keep) {
    std::array<double, kMaxCorners> height;
    bool all = true;
    for (std::size_t i = 0; i < count_; ++i) all &= (height[i] = keep(corners_[i])) >= 0;
    if (all) return;
    std::array<Vec2, kMaxCorners> kept;
    std::size_t n = 0;
    const auto add = [&](const Vec2& corner) {
      if (n < kMaxCorners) kept[n++] = corner;
    };
    clip_convex(
        {height.data(), count_}, [&](std::size_t i) { add(corners_[i]); },
        [&](std::size_t i, std::size_t j, double t) { add(corners_[i] + t * (corners_[j] - corners_[i])); });
    corners_ = kept;
    count_ = n < 3 ? 0 : n;
  }

 private:
  std::array<Vec2, kMaxCorners> corners_{};
  std::size_t count_ = 0;
};

}  // namespace sdm::gl
