// A box as a mesh.
#pragma once

#include <sdm/mesh.h>

namespace sdm::scenes {

/// 12 triangles, facing outward.
inline Mesh box_mesh(const Box& box) {
  Mesh mesh;
  // Bit k of a corner's index is set if the corner lies at the high end of axis k.
  for (int corner = 0; corner < 8; ++corner) {
    Vec3& p = mesh.positions.emplace_back();
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? box.upper[k] : box.lower[k];
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace sdm::scenes
