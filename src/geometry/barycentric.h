// Barycentric coordinates of points of triangles.
#pragma once

#include <algorithm>
#include <array>

#include "geometry/vec.h"

namespace sdm::core {

/// The coordinates of a point of the triangle: not negative, with a sum of 1 up to rounding, also if the
/// point lies beside the triangle by rounding, or the triangle has no area. The point that they give is as
/// accurate as p, also in needles, where ratios of areas are rounding errors.
///
/// Of the longest side ab, with s and t the parameters on it of p and of the third corner c, and w the share
/// of c's height that p has, the coordinates are w of c and s − w t of b. An error of w moves the point
/// across the side, by at most the height of c. Beyond a corner of ab, either s − w t or w is limited to what
/// the triangle contains: whichever moves the point less.
inline Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const std::array corners{a, b, c};
  std::size_t from = 0;
  double longest = -1;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double length = squared_norm(corners[(k + 1) % 3] - corners[k]); length > longest)
      from = k, longest = length;
  const std::size_t to = (from + 1) % 3, third = (from + 2) % 3;
  if (!(longest > 0)) return {1, 0, 0};

  const Vec3 side = corners[to] - corners[from];
  const auto along = [&](const Vec3& q) { return dot(q - corners[from], side) / longest; };
  const double s = along(p), t = along(corners[third]);
  const Vec3 height = corners[third] - corners[from] - t * side;
  const double squared_height = squared_norm(height);
  const double w = squared_height > 0
                       ? std::clamp(dot(p - corners[from] - s * side, height) / squared_height, 0.0, 1.0)
                       : 0;

  const auto weights_for = [&](double of_third) {
    Vec3 weights;
    weights[third] = of_third;
    weights[to] = std::clamp(s - of_third * t, 0.0, 1 - of_third);
    weights[from] = std::max(0.0, 1 - of_third - weights[to]);
    return weights;
  };
  const Vec3 weights = weights_for(w);
  const double most = std::max(0.0, std::min(t > 0 ? s / t : 1, t < 1 ? (1 - s) / (1 - t) : 1));
  if (w <= most) return weights;
  const auto error = [&](const Vec3& v) { return squared_norm(v[0] * a + v[1] * b + v[2] * c - p); };
  const Vec3 limited = weights_for(most);
  return error(limited) < error(weights) ? limited : weights;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
