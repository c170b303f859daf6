// Meshes of triangles of which nothing can be presumed.
#pragma once

#include <cmath>
#include <random>

#include "support/shapes.h"

namespace sdm::test {

/// Triangles that are needles, flat ones, points, segments, or copies of others.
inline Mesh degenerate_soup(std::size_t triangles, std::mt19937& random) {
  Mesh mesh = soup(triangles, random);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t f = 0; f < count; ++f) {
    const Triangle t = mesh.triangles[f];
    const double height = std::pow(10.0, -3 - static_cast<double>(f % 9));
    if (f % 5 == 0)
      mesh.positions[t[2]] = 0.5 * (mesh.positions[t[0]] + mesh.positions[t[1]]) + Vec3{height, 0, height};
    if (f % 7 == 0) mesh.positions[t[1]] = mesh.positions[t[0]];
    if (f % 11 == 0) mesh.positions[t[2]] = mesh.positions[t[1]];
    if (f % 3 == 0) {  // the same face, of vertices of its own
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const std::uint32_t v : t) mesh.positions.push_back(mesh.positions[v]);
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return mesh;
}

}  // namespace sdm::test
