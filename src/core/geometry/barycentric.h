// Barycentric coordinates of points of triangles.
#pragma once

#include <algorithm>

#include "core/geometry/vec.h"

namespace sdm::core {

/// The coordinates of the point of the longest side that is closest to p: not negative, with a sum of 1.
inline Vec3 barycentric_on_longest_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 corners[3] = {a, b, c};
  std::size_t from = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (squared_norm(corners[(k + 1) % 3] - corners[k]) >
        squared_norm(corners[(from + 1) % 3] - corners[from]))
      from = k;
  const std::size_t to = (from + 1) % 3;
  const Vec3 along = corners[to] - corners[from];
  const double length = squared_norm(along);
  Vec3 weights{};
  weights[to] = length > 0 ? std::clamp(dot(p - corners[from], along) / length, 0.0, 1.0) : 0;
  weights[from] = 1 - weights[to];
  return weights;
}

/// The coordinates of a point of the triangle: not negative, with a sum of 1 up to rounding, also if the
/// point lies beside the triangle by rounding, or the triangle has no area.
inline Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 corners[3] = {a, b, c}, normal = cross(b - a, c - a);
  if (!(squared_norm(normal) > 0)) return barycentric_on_longest_side(a, b, c, p);
  Vec3 weights{};
  for (std::size_t k = 0; k < 3; ++k)
    weights[k] = std::max(0.0, dot(normal, cross(corners[(k + 1) % 3] - p, corners[(k + 2) % 3] - p)));
  const double sum = weights[0] + weights[1] + weights[2];
  return sum > 0 ? (1 / sum) * weights : Vec3{1, 0, 0};
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
