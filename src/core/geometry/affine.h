// The pose of a mesh: an affine map of its points.
#pragma once

#include "core/geometry/vec.h"

namespace sdm::core {

/// p ↦ rows·p + offset. The identity returns every point bit-identical.
struct Affine {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 linear(const Vec3& v) const {
    return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
  }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear(p) + offset; }
};

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
