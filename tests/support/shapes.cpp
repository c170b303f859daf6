#include "support/shapes.h"

#include <cmath>
#include <map>
#include <numbers>

#include "support/points.h"

namespace sdm::test {
namespace {

constexpr double kPi = std::numbers::pi;

// The vertices `position(u, v)` for n × m angles, and the triangles between them.
template <class Position>
Mesh closed_grid(std::uint32_t n, std::uint32_t m, const Position& position) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j)
      mesh.positions.push_back(position(2 * kPi * i / n, 2 * kPi * j / m));
  const auto vertex = [=](std::uint32_t i, std::uint32_t j) { return i % n * m + j % m; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

}  // namespace

Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}};
}

Mesh cube(double half_side) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(half_side * Vec3{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh box(const Vec3& lo, const Vec3& hi) {
  Mesh mesh = cube();
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = p[k] < 0 ? lo[k] : hi[k];
  return mesh;
}

Mesh box(const Vec3& half_sides) {
  return box(-half_sides, half_sides);
}

Mesh sphere(int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, added] =
          midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (added) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = normalized(p);
  return mesh;
}

Mesh torus(std::uint32_t n, std::uint32_t m) {
  Mesh mesh = closed_grid(n, m, [](double u, double v) {
    return Vec3{static_cast<float>((2 + std::cos(v)) * std::cos(u)),
                static_cast<float>((2 + std::cos(v)) * std::sin(u)), static_cast<float>(std::sin(v))};
  });
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const auto uv = [&](std::uint32_t di, std::uint32_t dj) -> Vec2 {
        return {static_cast<double>(i + di) / n, static_cast<double>(j + dj) / m};
      };
      mesh.corner_uvs.push_back({uv(0, 0), uv(1, 0), uv(1, 1)});
      mesh.corner_uvs.push_back({uv(0, 0), uv(1, 1), uv(0, 1)});
    }
  return mesh;
}

Mesh ring(std::uint32_t n, double size, const Vec3& origin) {
  return closed_grid(n, n, [&](double a, double b) {
    const double r = 1 + 0.4 * std::cos(b);
    return Vec3{origin[0] + size * r * std::cos(a), origin[1] + size * r * std::sin(a),
                origin[2] + size * 0.4 * std::sin(b)};
  });
}

Mesh wedge(double half_angle) {
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

Mesh single_triangle() {
  return {.positions = {{0, 0, 0}, {1, 0, 0.2}, {0.3, 0.8, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}};
}

Mesh square(double side, double height) {
  const double h = side / 2;
  return {{{-h, -h, height}, {h, -h, height}, {h, h, height}, {-h, h, height}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

Mesh band(std::uint32_t n, bool crossed) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double u = 2 * kPi * i / n, turn = crossed ? u / 2 : 0;
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

Mesh spiral_ramp(int turns, int segments) {
  Mesh mesh;
  const auto pairs = static_cast<std::uint32_t>(turns * segments + 1);
  for (std::uint32_t i = 0; i < pairs; ++i) {
    const double t = 2 * kPi * i / segments;
    for (const double r : {2.0, 1.0}) mesh.positions.push_back({r * std::cos(t), r * std::sin(t), 0.02 * t});
  }
  for (std::uint32_t a = 0; a + 2 < 2 * pairs; a += 2) {
    mesh.triangles.push_back({a, a + 1, a + 2});
    mesh.triangles.push_back({a + 1, a + 3, a + 2});
  }
  return mesh;
}

Mesh fan(int slivers) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, 0});
  const auto count = static_cast<std::uint32_t>(slivers);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = 2 * kPi * i / slivers;
    mesh.positions.push_back({std::cos(t), std::sin(t), 0.1});
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  return mesh;
}

Mesh needles(double width) {
  Mesh mesh{.positions = {{0, 0, 0}}, .triangles = {}, .corner_uvs = {}};
  for (std::uint32_t i = 0; i <= 200; ++i) mesh.positions.push_back({1, width * i, 0.1 * std::sin(0.05 * i)});
  for (std::uint32_t i = 1; i <= 200; ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}

Mesh height_field(int n) {
  Mesh mesh;
  const auto index = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const double u = 1.0 * x / n, v = 1.0 * y / n;
      mesh.positions.push_back({u, v, 0.1 * std::sin(7 * u) * std::cos(5 * v)});
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      mesh.triangles.push_back({index(x, y), index(x + 1, y), index(x, y + 1)});
      mesh.triangles.push_back({index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)});
    }
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec2, 3>& uvs = mesh.corner_uvs.emplace_back();
    for (int k = 0; k < 3; ++k) uvs[k] = {mesh.positions[t[k]][0], mesh.positions[t[k]][1]};
  }
  return mesh;
}

Mesh soup(std::size_t triangles, std::mt19937& random) {
  const Box unit{{0, 0, 0}, {1, 1, 1}}, small{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vec3 middle = random_point(unit, random);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + random_point(small, random));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh degenerate_soup(std::size_t triangles, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3{unit(random), unit(random), unit(random)}; };
  Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto v = static_cast<std::uint32_t>(mesh.positions.size());
    const double size = std::exp(3 * unit(random));
    const Vec3 a = point(), b = a + size * point();
    Vec3 c = a + size * point();
    if (i % 10 == 1) c = a + 0.3 * (b - a) + 1e-12 * size * point();
    if (i % 50 == 2) c = b;
    for (const Vec3& p : {a, b, c}) mesh.positions.push_back(p);
    mesh.triangles.push_back({v, v + 1, v + 2});
    if (i % 10 == 3) mesh.triangles.push_back({v, v + 2, v + 1});
  }
  return mesh;
}

std::vector<Shape> with_atlases(std::span<const Mesh> meshes, std::uint32_t resolution) {
  std::vector<Shape> shapes;
  for (const Mesh& mesh : meshes) shapes.emplace_back(mesh, AtlasOptions{.resolution = resolution});
  return shapes;
}

Mesh with_own_uvs(Mesh mesh, std::uint32_t resolution) {
  const Surface charts(mesh, {.resolution = resolution});
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    auto& corners = mesh.corner_uvs.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Vec2 texel = charts.to_atlas(f, mesh.positions[mesh.triangles[f][k]]);
      corners[k] = {texel[0] / resolution, 1 - texel[1] / resolution};
    }
  }
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles) mesh.triangles.push_back({i + offset, j + offset, k + offset});
  mesh.corner_uvs.clear();
  return mesh;
}

Mesh taken_apart(const Mesh& mesh, double error, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> moved(-error, error);
  Mesh apart;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    apart.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : t) {
      Vec3 p = mesh.positions[v];
      for (double& x : p) x += moved(random);
      apart.positions.push_back(p);
    }
  }
  return apart;
}

Mesh moved(Mesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.positions) p += by;
  return mesh;
}

Mesh flipped(Mesh mesh, std::size_t every) {
  for (std::size_t i = 0; i < mesh.triangles.size(); i += every)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  mesh.corner_uvs.clear();
  return mesh;
}

Mesh with_defects(const Mesh& sound) {
  std::mt19937 random(9);
  Mesh mesh = flipped(sound, 3);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; i += 20) {
    const auto [a, b, c] = mesh.triangles[i];
    const auto added = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(mesh.positions[a] + random_point({{-.05, -.05, -.05}, {.05, .05, .05}}, random));
    mesh.positions.push_back(0.5 * (mesh.positions[b] + mesh.positions[c]));
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{a, b, added}, {c, b, a}, {a, a, b}, {b, c, added + 1}, {added + 1, added + 1, added + 1}});
  }
  return mesh;
}

}  // namespace sdm::test
