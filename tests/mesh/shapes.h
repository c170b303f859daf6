// Small meshes made in code, with properties that are known.
#pragma once

#include <sdm/mesh.h>

#include <cmath>
#include <numbers>

namespace sdm::test {

/// Vertices at the origin and the unit vectors: closed, oriented outwards, volume 1/6.
inline Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}};
}

/// A closed wedge of twice this angle about the plane z = 0. Its sharp edge, along x, has a vertex on one
/// side only, and between them a sliver.
inline Mesh wedge(double half_angle) {
  const double c = std::cos(half_angle), s = std::sin(half_angle);
  return {{{0, 0, 0}, {1, 0, 0}, {0, c, s}, {1, c, s}, {0, c, -s}, {1, c, -s}, {0.37, 0, 0}},
          {{0, 2, 3},
           {0, 3, 1},
           {0, 6, 4},
           {6, 5, 4},
           {6, 1, 5},
           {2, 4, 5},
           {2, 5, 3},
           {0, 4, 2},
           {1, 3, 5},
           {0, 1, 6}},
          {}};
}

/// A band of n quads whose ends are joined, `crossed` (Möbius) or not; 2n triangles, open.
inline Mesh band(std::uint32_t n, bool crossed) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n, turn = crossed ? u / 2 : 0;
    for (const double w : {-0.5, 0.5})
      mesh.positions.push_back({(2 + w * std::sin(turn)) * std::cos(u),
                                (2 + w * std::sin(turn)) * std::sin(u), w * std::cos(turn)});
    const std::uint32_t a = 2 * i, b = 2 * i + 1;
    std::uint32_t c = 2 * ((i + 1) % n), d = c + 1;
    if (crossed && i + 1 == n) std::swap(c, d);
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  return mesh;
}

/// A torus of n × m quads, cut into triangles: closed, oriented outwards, one hole. Coordinates are exact in
/// single precision; texture coordinates are multiples of 1/n and 1/m, with seams.
inline Mesh torus(std::uint32_t n, std::uint32_t m) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      mesh.positions.push_back({static_cast<float>((2 + std::cos(v)) * std::cos(u)),
                                static_cast<float>((2 + std::cos(v)) * std::sin(u)),
                                static_cast<float>(std::sin(v))});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const auto vertex = [&](std::uint32_t di, std::uint32_t dj) { return (i + di) % n * m + (j + dj) % m; };
      const auto uv = [&](std::uint32_t di, std::uint32_t dj) -> Vec2 {
        return {static_cast<double>(i + di) / n, static_cast<double>(j + dj) / m};
      };
      mesh.triangles.push_back({vertex(0, 0), vertex(1, 0), vertex(1, 1)});
      mesh.corner_uvs.push_back({uv(0, 0), uv(1, 0), uv(1, 1)});
      mesh.triangles.push_back({vertex(0, 0), vertex(1, 1), vertex(0, 1)});
      mesh.corner_uvs.push_back({uv(0, 0), uv(1, 1), uv(0, 1)});
    }
  return mesh;
}

/// Adds the vertices and faces of `other`, sharing nothing.
inline void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace sdm::test
