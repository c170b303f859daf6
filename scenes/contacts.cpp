#include "scenes/contacts.h"

#include <sdm/closest_points.h>

#include "geometry/vec.h"

namespace sdm::scenes {
namespace {

// Barycentric coordinates of a point in the plane of the triangle.
Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = cross(b - a, c - a);
  const double area = squared_norm(n);
  if (!(area > 0)) return {1, 0, 0};
  const double at_b = std::clamp(dot(cross(p - a, c - a), n) / area, 0.0, 1.0),
               at_c = std::clamp(dot(cross(b - a, p - a), n) / area, 0.0, 1.0 - at_b);
  return {1 - at_b - at_c, at_b, at_c};
}

}  // namespace

std::vector<VertexContact> find_contacts(std::span<const Vec3> points, const Sites& solid, double margin) {
  Box reach = bounds(solid.mesh());
  for (int k = 0; k < 3; ++k) {
    reach.lower[k] -= margin;
    reach.upper[k] += margin;
  }
  std::vector<std::uint32_t> indices;
  std::vector<Vec3> near;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (contains(reach, points[i])) {
      indices.push_back(i);
      near.push_back(points[i]);
    }

  const SignMethod method = solid.closed() && solid.orientable() ? SignMethod::exact : SignMethod::winding;
  const std::vector<ClosestPoint> closest = closest_points(solid, near);
  const std::vector<std::uint8_t> is_inside = inside_flags(solid, near, closest, method);
  std::vector<VertexContact> contacts;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double distance = is_inside[i] ? -closest[i].distance : closest[i].distance;
    if (distance >= margin || distance == 0) continue;  // at distance 0 the normal is undefined
    const Triangle& face = solid.mesh().triangles[closest[i].face];
    const std::vector<Vec3>& corners = solid.mesh().positions;
    contacts.push_back(
        {.point = indices[i],
         .face = face,
         .weights = barycentric(closest[i].point, corners[face[0]], corners[face[1]], corners[face[2]]),
         .normal = (1 / distance) * (near[i] - closest[i].point),
         .depth = margin - distance});
  }
  return contacts;
}

}  // namespace sdm::scenes
