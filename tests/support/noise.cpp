#include "support/noise.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace sdm::test {
namespace {

/// By Box and Muller: the same numbers with every standard library.
double next_normal(std::mt19937_64& random) {
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double u = 1 - uniform(), v = uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

}  // namespace

Mesh with_noise(Mesh mesh, double along_normals, double all_ways) {
  std::vector<Vec3> normals(mesh.positions.size());
  double edge = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    edge += norm(b - a) + norm(c - b) + norm(a - c);
    for (const std::uint32_t v : t) normals[v] += cross(b - a, c - a);
  }
  edge /= 3 * static_cast<double>(mesh.triangles.size());
  std::mt19937_64 random(1);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    mesh.positions[v] += (along_normals * edge * next_normal(random)) * normalized(normals[v]);
    for (double& x : mesh.positions[v]) x += all_ways * edge * next_normal(random);
  }
  return mesh;
}

}  // namespace sdm::test
