#include "closest/facing/facing_normals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "closest/facing/facing_angle.h"
#include "closest/facing/outward_normals.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm::facing {
namespace {

constexpr double kLow = 1e-3;         // of the diagonal
constexpr double kLeastSum = 0.5;     // of the area of the surroundings
constexpr double kLeastAround = 2.0;  // times the area of the face

/// Normals of faces together, weighted by their areas.
struct AreaVector {
  Vec3 sum{};
  double area = 0;

  void add(const AreaVector& other, double times) {
    sum += times * other.sum;
    area += times * other.area;
  }
};

AreaVector area_vector(const Mesh& mesh, std::size_t face, const Vec3& normal) {
  const auto [a, b, c] = corners_of(mesh, face);
  const double area = norm(cross(b - a, c - a)) / 2;
  return {area * normal, area};
}

double least_height(const Mesh& mesh, std::size_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return norm(cross(b - a, c - a)) / std::max({norm(b - a), norm(c - b), norm(a - c)});
}

FacingNormals with_surroundings(const Mesh& mesh, std::vector<Vec3> normals, double angle) {
  const FacingAngle facing(angle);
  FacingNormals result{.normals = std::move(normals), .height = kLow * diagonal(bounds(mesh))};
  std::vector<std::uint32_t> low;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    if (result.normals[f] != Vec3{} && least_height(mesh, f) < result.height) low.push_back(f);
  if (low.empty()) return result;

  std::vector<AreaVector> at_vertex(mesh.positions.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    if (result.normals[f] != Vec3{})
      for (const std::uint32_t v : mesh.triangles[f])
        at_vertex[v].add(area_vector(mesh, f, result.normals[f]), 1);
  for (const std::uint32_t f : low) {
    Vec3& normal = result.normals[f];
    const AreaVector own = area_vector(mesh, f, normal);
    AreaVector around;
    for (const std::uint32_t v : mesh.triangles[f]) around.add(at_vertex[v], 1);
    around.add(own, -3);
    const double length = norm(around.sum);
    if (length < kLeastSum * around.area || around.area < 3 * kLeastAround * own.area) continue;
    const Vec3 outward = (1 / length) * around.sum;
    if (facing.allows(dot(outward, normal))) continue;
    normal = outward;
    result.replaced.push_back(f);
  }
  return result;
}

}  // namespace

FacingNormals facing_normals(const Mesh& mesh, double angle) {
  return with_surroundings(mesh, outward_normals(mesh), angle);
}

FacingNormals facing_normals(const Surface& surface, double angle) {
  return with_surroundings(surface.mesh(), outward_normals(surface), angle);
}

}  // namespace sdm::facing
