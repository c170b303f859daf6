// Small meshes whose numbers of faces are no multiples of what the library works on at once.
#pragma once

#include <sdm/mesh.h>

#include <random>
#include <vector>

#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {

/// The first faces of a mesh; vertices of other faces stay, unused.
inline Mesh first_faces(Mesh mesh, std::size_t count) {
  mesh.triangles.resize(count);
  if (!mesh.corner_uvs.empty()) mesh.corner_uvs.resize(count);
  return mesh;
}

/// A closed box with each side a grid of n² squares, and faces that share vertices within a side only.
inline Mesh grid_block(const Vec3& lo, const Vec3& hi, int n) {
  Mesh mesh;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          Vec3 p{};
          p[axis] = high ? hi[axis] : lo[axis];
          p[u] = lo[u] + (hi[u] - lo[u]) * i / n;
          p[v] = lo[v] + (hi[v] - lo[v]) * j / n;
          mesh.positions.push_back(p);
        }
      const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (n + 1) + j); };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (const auto& [a, b, c] : {Triangle{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                                        Triangle{at(i, j), at(i + 1, j + 1), at(i, j + 1)}})
            mesh.triangles.push_back(high ? Triangle{a, b, c} : Triangle{a, c, b});
    }
  return mesh;
}

/// A square of n² squares with texture coordinates from 0 to 1, at this height, facing up.
inline Mesh grid_square(double side, double height, int n) {
  Mesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      mesh.positions.push_back({side * i / n - side / 2, side * j / n - side / 2, height});
  const auto at = [=](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  const auto uv = [=](int i, int j) { return Vec2{1.0 * i / n, 1.0 * j / n}; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.corner_uvs.push_back({uv(i, j), uv(i + 1, j), uv(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      mesh.corner_uvs.push_back({uv(i, j), uv(i + 1, j + 1), uv(i, j + 1)});
    }
  return mesh;
}

/// Meshes of 1 to 17 faces, one more than a leaf of a tree has; with faces without area, with several
/// vertices at one place, with repeated faces, and far from the origin.
inline std::vector<Mesh> awkward_meshes() {
  std::vector<Mesh> meshes{single_triangle(), square(1, 0.1), tetrahedron()};
  for (const std::size_t count : {3, 5, 7, 9, 15, 16, 17}) meshes.push_back(first_faces(sphere(1), count));
  meshes.push_back(degenerate_soup(33, 4));
  meshes.push_back(taken_apart(cube(), 0));
  meshes.push_back(with_defects(torus(5, 4)));
  meshes.push_back(moved(sphere(1), {1e5, -2e5, 3e5}));
  return meshes;
}

/// The box of a mesh, larger by half of its diagonal to all sides.
inline Box around(const Mesh& mesh) {
  Box box = bounds(mesh);
  const double margin = 0.5 * scene_diagonal(mesh, mesh);
  for (std::size_t k = 0; k < 3; ++k) {
    box.lower[k] -= margin;
    box.upper[k] += margin;
  }
  return box;
}

inline std::vector<Vec3> random_points(const Box& box, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random_point(box, random));
  return points;
}

/// The mesh, whose points are mapped by a function.
template <class Map>
Mesh mapped_by(Mesh mesh, const Map& map) {
  for (Vec3& p : mesh.positions) p = map(p);
  return mesh;
}

inline Vec3 vec3(const Vec3f& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace sdm::test
