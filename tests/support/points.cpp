#include "support/points.h"

#include <cmath>

#include "geometry/vec.h"

namespace sdm::test {

Vec3 random_point(const Box& box, std::mt19937& random) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution(box.lower[k], box.upper[k])(random);
  return p;
}

std::vector<Vec3> random_surface_points(const Mesh& mesh, std::size_t count, std::mt19937& random) {
  std::vector<double> areas;
  for (const auto& [a, b, c] : mesh.triangles)
    areas.push_back(
        norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
  std::discrete_distribution<std::size_t> face(areas.begin(), areas.end());
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = mesh.triangles[face(random)];
    const double s = std::sqrt(unit(random)), t = unit(random);
    points.push_back((1 - s) * mesh.positions[a] + (s * (1 - t)) * mesh.positions[b] +
                     (s * t) * mesh.positions[c]);
  }
  return points;
}

double scene_diagonal(const Mesh& o1, const Mesh& o2) {
  Box box = bounds(o1);
  extend(box, bounds(o2));
  return diagonal(box);
}

}  // namespace sdm::test
