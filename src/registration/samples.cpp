#include "registration/samples.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "geometry/spatial_order.h"
#include "geometry/vec.h"

namespace sdm::registration {
namespace {

Samples in_spatial_order(const Samples& samples) {
  Samples result;
  const std::vector<std::uint32_t> order = spatial_order(samples.points);
  for (const std::uint32_t i : order) result.points.push_back(samples.points[i]);
  if (!samples.normals.empty())
    for (const std::uint32_t i : order) result.normals.push_back(samples.normals[i]);
  return result;
}

double fraction(double x) {
  return x - std::floor(x);
}

}  // namespace

SampleSource surface_source(const Mesh& mesh) {
  // The area of all faces up to each, relative to the largest so that squares of sizes stay in range.
  const auto sides = [&mesh](std::size_t face) {
    const Triangle& t = mesh.triangles[face];
    const Vec3& p = mesh.positions[t[0]];
    return std::array{mesh.positions[t[1]] - p, mesh.positions[t[2]] - p};
  };
  const double size = diagonal(bounds(mesh));
  auto areas = std::make_shared<std::vector<double>>(mesh.triangles.size());
  double sum = 0;
  for (std::size_t face = 0; face < areas->size(); ++face) {
    const auto [a, b] = sides(face);
    (*areas)[face] = sum += norm(cross((1 / size) * a, (1 / size) * b));
  }
  return [&mesh, areas, sides, size](std::size_t count) {
    Samples samples;
    std::size_t face = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * areas->back();
      while ((*areas)[face] <= share && face + 1 < areas->size()) ++face;
      // The R2 sequence, Roberts 2018: low discrepancy in the unit square, folded into the triangle.
      double u = fraction(0.5 + 0.7548776662466927 * static_cast<double>(i));
      double v = fraction(0.5 + 0.5698402909980532 * static_cast<double>(i));
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const auto [a, b] = sides(face);
      samples.points.push_back(mesh.positions[mesh.triangles[face][0]] + u * a + v * b);
      samples.normals.push_back(normalized(cross((1 / size) * a, (1 / size) * b)));
    }
    return in_spatial_order(samples);
  };
}

SampleSource cloud_source(std::span<const Vec3> points, std::span<const Vec3> normals) {
  return [points, normals](std::size_t count) {
    Samples samples;
    // One point from each of `count` equal runs of the input, so that neither order nor duplicates matter.
    std::minstd_rand random;  // its sequence is that of the standard
    const std::size_t used = std::min(count, points.size());
    for (std::size_t i = 0; i < used; ++i) {
      const std::size_t begin = i * points.size() / used, end = (i + 1) * points.size() / used;
      const std::size_t at = begin + random() % (end - begin);
      samples.points.push_back(points[at]);
      if (!normals.empty()) samples.normals.push_back(normalized(normals[at]));
    }
    return in_spatial_order(samples);
  };
}

}  // namespace sdm::registration
