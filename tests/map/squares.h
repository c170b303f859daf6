// Squares parallel to the plane z = 0.
#pragma once

#include <sdm/mesh.h>

namespace sdm::test {

/// Centred on the z axis at this height.
inline Mesh square(double side, double height) {
  const double h = side / 2;
  return {{{-h, -h, height}, {h, -h, height}, {h, h, height}, {-h, h, height}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

}  // namespace sdm::test
