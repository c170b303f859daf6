// The pose of a mesh: an affine map of its points.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <cmath>

namespace sdm::core {

/// p ↦ rows·p + offset. The identity returns every point bit-identical.
struct Affine {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 linear(const Vec3& v) const {
    return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
  }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear(p) + offset; }
  friend bool operator==(const Affine&, const Affine&) = default;
};

/// (a * b)(p) = a(b(p)) up to rounding; exact if one of them is the identity.
inline Affine operator*(const Affine& a, const Affine& b) {
  Affine result;
  for (int i = 0; i < 3; ++i)
    result.rows[i] = a.rows[i][0] * b.rows[0] + a.rows[i][1] * b.rows[1] + a.rows[i][2] * b.rows[2];
  result.offset = a(b.offset);
  return result;
}

/// A box that contains the image of a box, and of its points as they are rounded.
inline Box image(const Affine& map, const Box& box) {
  if (map == Affine{}) return box;
  Box result{map.offset, map.offset};
  for (int i = 0; i < 3; ++i) {
    double magnitude = std::abs(map.offset[i]);
    for (int j = 0; j < 3; ++j) {
      const double a = map.rows[i][j] * box.lower[j], b = map.rows[i][j] * box.upper[j];
      result.lower[i] += std::min(a, b);
      result.upper[i] += std::max(a, b);
      magnitude += std::max(std::abs(a), std::abs(b));
    }
    result.lower[i] -= 1e-15 * magnitude;
    result.upper[i] += 1e-15 * magnitude;
  }
  return result;
}

/// The inverse map; not finite if the map is singular.
inline Affine inverse(const Affine& map) {
  const auto& [x, y, z] = map.rows;
  const Vec3 columns[3] = {cross(y, z), cross(z, x), cross(x, y)};
  const double scale = 1 / dot(x, columns[0]);
  Affine result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result.rows[i][j] = scale * columns[j][i];
  result.offset = -result.linear(map.offset);
  return result;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
