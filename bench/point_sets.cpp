#include "point_sets.h"

#include <sdm/surface.h>

#include <cmath>
#include <random>

#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "scenes.h"

namespace sdm::bench {
namespace {

/// Uniform in a box `factor` times as large as that of the mesh, about its centre.
std::vector<Vec3> uniform(const Mesh& mesh, std::size_t count, double factor) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.5 - factor / 2, 0.5 + factor / 2);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = box.lower[k] + part(random) * (box.upper[k] - box.lower[k]);
  return points;
}
std::vector<Vec3> in_box(const Mesh& mesh, std::size_t count) {
  return uniform(mesh, count, 1);
}

/// Uniform in [−5, 5]³ about its centre.
std::vector<Vec3> far_away(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    p = 0.5 * (box.lower + box.upper) + Vec3{coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

/// 30 diagonals from the centre of its box, in all directions.
std::vector<Vec3> remote(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::normal_distribution<double> coordinate;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    for (double& x : p) x = coordinate(random);
    p = 0.5 * (box.lower + box.upper) + 30 * diagonal(box) / norm(p) * p;
  }
  return points;
}

/// The nodes of a grid that fills the box, row by row; about `count` of them.
std::vector<Vec3> grid(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  const auto side = static_cast<std::size_t>(std::cbrt(static_cast<double>(count)));
  std::vector<Vec3> points;
  for (std::size_t z = 0; z < side; ++z)
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        Vec3& p = points.emplace_back();
        const std::size_t index[3] = {x, y, z};
        for (int k = 0; k < 3; ++k)
          p[k] = std::lerp(box.lower[k], box.upper[k],
                           static_cast<double>(index[k]) / static_cast<double>(side - 1));
      }
  return points;
}

/// Uniform on the surface, and moved by a normal distribution of this deviation.
std::vector<Vec3> near_surface(const Mesh& mesh, std::size_t count, double deviation) {
  std::mt19937 random(7);
  std::vector<double> area;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(mesh, f);
    area.push_back(norm(cross(b - a, c - a)));
  }
  std::discrete_distribution<std::size_t> face(area.begin(), area.end());
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> offset(0, deviation);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const auto [a, b, c] = corners_of(mesh, face(random));
    const double root = std::sqrt(part(random)), along = part(random);
    p = (1 - root) * a + root * (1 - along) * b + root * along * c;
    for (int k = 0; k < 3; ++k) p[k] += offset(random);
  }
  return points;
}
std::vector<Vec3> near_1e2(const Mesh& mesh, std::size_t count) {
  return near_surface(mesh, count, 1e-2);
}
std::vector<Vec3> near_1e3(const Mesh& mesh, std::size_t count) {
  return near_surface(mesh, count, 1e-3);
}

/// The samples of a map from another mesh that penetrates this one, in the order of the map.
std::vector<Vec3> samples_of_map(std::uint32_t resolution) {
  const Surface surface(load("bunny.obj", "fit,translate:-0.1:0:0"), {.resolution = resolution});
  std::vector<Vec3> points;
  for (const std::uint32_t texel : surface.sample_texels()) points.push_back(surface.texel_point(texel));
  return points;
}
std::vector<Vec3> map_512(const Mesh&, std::size_t) {
  return samples_of_map(512);
}
std::vector<Vec3> map_1024(const Mesh&, std::size_t) {
  return samples_of_map(1024);
}

}  // namespace

std::vector<Vec3> points_around_box(const Mesh& mesh, std::size_t count) {
  return uniform(mesh, count, 1.5);
}

std::span<const PointSet> point_sets() {
  static constexpr PointSet kSets[] = {
      {"far", "uniform in [-5, 5]^3", far_away},
      {"remote", "30 diagonals away", remote},
      {"box-1.5", "uniform in 1.5 times the box", points_around_box},
      {"box", "uniform in the box", in_box},
      {"grid", "a grid in the box", grid},
      {"near-1e-2", "near the surface, sigma 1e-2", near_1e2},
      {"near-1e-3", "near the surface, sigma 1e-3", near_1e3},
      {"map-512", "samples of a map of 512^2, penetrating, in its order", map_512},
      {"map-1024", "samples of a map of 1024^2, penetrating, in its order", map_1024},
  };
  return kSets;
}

}  // namespace sdm::bench
