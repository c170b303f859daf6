// The point of a triangle that is closest to a point p: in the interior if p is above or below the triangle,
// otherwise on a side or at a corner. The interior has two forms, which are exact in different respects:
//   closest_feature()      seen from p, along the normal: a point in the plane of the triangle has
//                          distance 0. An error of the normal moves the result off the triangle.
//   closest_on_triangle()  a mean of the corners: on the triangle to rounding, so the distance is never too
//                          small, and the shape may be any.
// lanes/point_triangle-inl.h has the second form for several points or triangles at once.
#pragma once

#include <cstdint>
#include <limits>

#include "geometry/triangle.h"

namespace sdm::core {

enum class TriangleFeature : std::uint8_t { corner, side, interior };

struct ClosestFeature {
  Vec3 point{};
  double squared = kInfinity;  ///< |point − p|²
  TriangleFeature feature = TriangleFeature::interior;
  int index = 0;  ///< of the corner, or of the side, which starts at this corner
};

/// The closest point, and which feature of the triangle it lies on. `flat`: the normal is reliable. That of a
/// needle is rounding noise, which may place p over the triangle: its sides represent it instead, and the
/// distance may be too large by its height.
[[nodiscard]] inline ClosestFeature closest_feature(const Vec3& p, const Corners& corner, bool flat) {
  const Corners side{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]},
      from{p - corner[0], p - corner[1], p - corner[2]};
  const Vec3 normal = cross(side[0], side[1]);
  ClosestFeature best;
  bool over = flat;
  for (int k = 0; k < 3; ++k) {
    // The closest point is on a side that p lies beyond, if there is one.
    if (flat && dot(from[k], cross(normal, side[k])) > 0) continue;
    over = false;
    const double along = dot(from[k], side[k]), length = squared_norm(side[k]);
    ClosestFeature found;
    if (along <= 0 || along >= length) {
      found.feature = TriangleFeature::corner;
      found.index = along <= 0 ? k : (k + 1) % 3;
      found.point = corner[found.index];
    } else {
      found.feature = TriangleFeature::side;
      found.index = k;
      found.point = corner[k] + (along / length) * side[k];
    }
    found.squared = squared_norm(found.point - p);
    if (found.squared < best.squared) best = found;
  }
  if (over) {
    best.point = p - (dot(from[0], normal) / squared_norm(normal)) * normal;
    best.squared = squared_norm(best.point - p);
  }
  return best;
}

/// Features of a triangle of any shape, for a few points.
struct FewSides {
  Corners corner, side;

  explicit FewSides(const Corners& t) : corner(t), side{t[1] - t[0], t[2] - t[1], t[0] - t[2]} {}

  /// 1 / x, or 0 if x underflows.
  static double inverse(double x) { return x > std::numeric_limits<double>::min() ? 1 / x : 0; }

  [[nodiscard]] Vec3 on_side(int k, const Vec3& p) const {
    return on_side(k, p, inverse(squared_norm(side[k])));
  }
  /// Whether the orthogonal projection of p lies in the interior; `foot` receives it.
  [[nodiscard]] bool over(const Vec3& p, Vec3& foot) const {
    const Vec3 normal = cross(side[0], side[1]);
    return over(p, foot, normal, inverse(squared_norm(normal)));
  }

 protected:
  [[nodiscard]] Vec3 on_side(int k, const Vec3& p, double inverse_squared) const {
    return corner[k] + std::clamp(dot(p - corner[k], side[k]) * inverse_squared, 0.0, 1.0) * side[k];
  }
  [[nodiscard]] bool over(const Vec3& p, Vec3& foot, const Vec3& normal, double inverse_normal) const {
    // n·(r × s) = (n × r)·s: the barycentric coordinates of corners 1 and 2.
    const Vec3 turned = cross(normal, p - corner[0]);
    const double v = -dot(turned, side[2]) * inverse_normal, w = -dot(turned, side[0]) * inverse_normal;
    if (!(v > 0 && w > 0 && v + w < 1)) return false;
    foot = corner[0] + v * side[0] - w * side[2];
    return true;
  }
};

/// The same for many points: of the same bits.
struct TriangleSides : FewSides {
  Vec3 normal, inverse_squared;  // of sides: 1 / length², or 0
  double inverse_normal;         // 1 / |normal|², or 0

  explicit TriangleSides(const Corners& t) : FewSides(t), normal(cross(side[0], side[1])) {
    for (int k = 0; k < 3; ++k) inverse_squared[k] = inverse(squared_norm(side[k]));
    inverse_normal = inverse(squared_norm(normal));
  }

  [[nodiscard]] Vec3 on_side(int k, const Vec3& p) const {
    return FewSides::on_side(k, p, inverse_squared[k]);
  }
  [[nodiscard]] bool over(const Vec3& p, Vec3& foot) const {
    return FewSides::over(p, foot, normal, inverse_normal);
  }
};

/// The closest point of a triangle of any shape, including needles, segments and points.
[[nodiscard]] inline Vec3 closest_on_triangle(const Vec3& p, const Corners& corners) {
  const TriangleSides t(corners);
  Vec3 closest = t.on_side(0, p), foot;
  double least = squared_norm(closest - p);
  const auto offer = [&](const Vec3& point) {
    if (const double squared = squared_norm(point - p); squared < least) {
      closest = point;
      least = squared;
    }
  };
  offer(t.on_side(1, p));
  offer(t.on_side(2, p));
  if (t.over(p, foot)) offer(foot);
  return closest;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
