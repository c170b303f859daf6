// Height fields, and the normals of faces.
#pragma once

#include <sdm/mesh.h>

#include <algorithm>
#include <cmath>

#include "support/shapes.h"

namespace sdm::test {

/// The unit normal of a face; 0 without area.
[[nodiscard]] inline Vec3 normal_of(const Mesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return normalized(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

/// A grid of n × n squares over [0, 20]² with heights by f.
template <class Height>
[[nodiscard]] Mesh terrain(int n, const Height& f) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 20.0 * i / n, y = 20.0 * j / n;
      mesh.positions.push_back({x, y, f(x, y)});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + static_cast<std::uint32_t>(n) + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

/// A scan of the upper side of thick_plate(), with a dent of this depth about (10, 10).
[[nodiscard]] inline Mesh dented(int n, double depth) {
  return terrain(n, [depth](double x, double y) {
    const double u = std::max(0.0, 1 - (std::pow(x - 10, 2) + std::pow(y - 10, 2)) / 16);
    return -depth * u * u;
  });
}

/// A closed plate over [−5, 25]², with its upper side at 0.
[[nodiscard]] inline Mesh thick_plate(double thickness) {
  Mesh mesh = cube(1);
  for (Vec3& p : mesh.positions) p = {10 + 15 * p[0], 10 + 15 * p[1], thickness * (p[2] - 1) / 2};
  return mesh;
}

}  // namespace sdm::test
