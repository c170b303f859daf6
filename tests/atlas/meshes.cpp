#include "atlas/meshes.h"

#include <sdm/io.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "core/geometry/vec.h"

namespace sdm::test {
namespace {

constexpr double kPi = std::numbers::pi;

// Two triangles between the i-th and the next pair of positions.
void add_band(Mesh& mesh, std::uint32_t i, std::uint32_t pairs) {
  const std::uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % pairs), d = c + 1;
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({b, d, c});
}

}  // namespace

Mesh load(const std::string& name) {
  return read_mesh(std::filesystem::path(SDM_TEST_MESHES) / name);
}

Mesh soup(std::size_t triangles, unsigned seed) {
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

Mesh moebius_strip(int segments) {
  Mesh mesh;
  for (int i = 0; i < segments; ++i) {
    const double t = 2 * kPi * i / segments;
    for (const double w : {-0.3, 0.3}) {
      const double r = 1 + w * std::cos(t / 2);
      mesh.positions.push_back({r * std::cos(t), r * std::sin(t), w * std::sin(t / 2)});
    }
  }
  for (int i = 0; i + 1 < segments; ++i)
    add_band(mesh, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(segments));
  const auto last = static_cast<std::uint32_t>(2 * segments - 2);
  mesh.triangles.push_back({last, last + 1, 1});
  mesh.triangles.push_back({last + 1, 0, 1});
  return mesh;
}

Mesh spiral_ramp(int turns, int segments) {
  Mesh mesh;
  const int pairs = turns * segments + 1;
  for (int i = 0; i < pairs; ++i) {
    const double t = 2 * kPi * i / segments;
    for (const double r : {2.0, 1.0}) mesh.positions.push_back({r * std::cos(t), r * std::sin(t), 0.02 * t});
  }
  for (int i = 0; i + 1 < pairs; ++i)
    add_band(mesh, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(pairs));
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

}  // namespace sdm::test
