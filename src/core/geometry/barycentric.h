// Barycentric coordinates of points of triangles.
#pragma once

#include <algorithm>

#include "core/geometry/vec.h"

namespace sdm::core {

/// The coordinates of a point of the triangle: not negative, with a sum of 1 up to rounding, also if the
/// point lies beside the triangle by rounding, or the triangle has no area.
inline Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 corners[3] = {a, b, c}, normal = cross(b - a, c - a);
  const double squared = squared_norm(normal);
  Vec3 weights{};
  if (squared > 0) {
    for (std::size_t k = 0; k < 3; ++k)
      weights[k] = std::max(0.0, dot(normal, cross(corners[(k + 1) % 3] - p, corners[(k + 2) % 3] - p)));
  } else {  // along the longest edge
    std::size_t from = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squared_norm(corners[(k + 1) % 3] - corners[k]) >
          squared_norm(corners[(from + 1) % 3] - corners[from]))
        from = k;
    const std::size_t to = (from + 1) % 3;
    const Vec3 along = corners[to] - corners[from];
    const double length = squared_norm(along);
    weights[to] = length > 0 ? std::clamp(dot(p - corners[from], along) / length, 0.0, 1.0) : 0;
    weights[from] = 1 - weights[to];
  }
  const double sum = weights[0] + weights[1] + weights[2];
  return sum > 0 ? (1 / sum) * weights : Vec3{1, 0, 0};
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
