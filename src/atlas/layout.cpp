#include "atlas/layout.h"

#include "geometry/vec.h"

namespace sdm::atlas {

std::array<Vec3, 2> affine_edges(const std::array<Vec2, 3>& corners, std::span<const Vec3> positions,
                                 const Triangle& t) {
  const Vec3 &origin = positions[t[0]], first = positions[t[1]] - origin, second = positions[t[2]] - origin;
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double det = cross(a, b);
  return {(1 / det) * (b[1] * first - a[1] * second), (1 / det) * (a[0] * second - b[0] * first)};
}

}  // namespace sdm::atlas
