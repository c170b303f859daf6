// Height fields, and the normals of faces.
#pragma once

#include <sdm/mesh.h>

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

}  // namespace sdm::test
