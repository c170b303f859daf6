#include "atlas/layout.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

namespace sdm::atlas {

std::array<Vec3, 2> affine_edges(const std::array<Vec2, 3>& corners, std::span<const Vec3> positions,
                                 const Triangle& t) {
  const Vec3 &origin = positions[t[0]], first = positions[t[1]] - origin, second = positions[t[2]] - origin;
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double det = cross(a, b);
  return {(1 / det) * (b[1] * first - a[1] * second), (1 / det) * (a[0] * second - b[0] * first)};
}

bool is_needle(const std::array<Vec2, 3>& corners) {
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[2] - corners[1];
  constexpr double kThin = 3e-8;  // of a side, about the root of what rounded products are off by
  return std::abs(cross(a, b)) <= kThin * std::max({dot(a, a), dot(b, b), dot(c, c)});
}

std::array<Vec3, 2> moved_edges(const std::array<Vec2, 3>& corners, std::span<const Vec3> positions,
                                const Triangle& t) {
  if (!is_needle(corners)) return affine_edges(corners, positions, t);
  std::array<Vec3, 2> edges{};
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec2 side = corners[next] - corners[k];
    const double squared = dot(side, side);
    if (squared <= longest) continue;
    longest = squared;
    const Vec3 moved = positions[t[next]] - positions[t[k]];
    edges = {side[0] / squared * moved, side[1] / squared * moved};
  }
  return edges;
}

}  // namespace sdm::atlas
