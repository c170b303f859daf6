// Whether the closest points of a map on a device are what sdm/gpu.h says.
#pragma once

#include <sdm/gpu.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/point_triangle.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::test {

/// How many are farther from their site than they may be, or their vectors too long or too short, or on a
/// site that is not of their face. `samples` and `distances`: the samples and their exact distances; `o2`:
/// the present mesh.
inline std::size_t wrong_closest(const GpuMap& map, const Sites& sites, const Mesh& o2,
                                 std::span<const Vec3> samples, std::span<const double> distances) {
  const GpuMapClosest closest = map.closest();
  if (closest.vector.size() != samples.size()) return samples.size();
  const auto is_right = [&](std::size_t i) {
    const Vec3f& v = closest.vector[i];
    const Vec3 vector{v[0], v[1], v[2]}, end = samples[i] + vector;
    const double error = map.error(distances[i]);
    const auto on = [&](const Vec3& point) { return norm(end - point) <= error; };
    const std::uint32_t face = closest.face[i], site = closest.site[i];
    if (!(std::abs(norm(vector) - distances[i]) <= 4 * error) || face >= o2.triangles.size()) return false;
    const Triangle& corners = o2.triangles[face];
    if (!on(closest_on_triangle(end, corners_of(o2, face)))) return false;
    if (closest.site_type[i] == SiteType::vertex)
      return std::ranges::find(corners, site) != corners.end() && on(o2.positions[site]);
    if (closest.site_type[i] == SiteType::edge) {
      const auto& of_face = internals(sites).topology.face_edges[face];
      if (std::ranges::find(of_face, site) == of_face.end()) return false;
      const auto [a, b] = sites.edges()[site];
      return on(closest_on_segment(end, o2.positions[a], o2.positions[b]));
    }
    return closest.site_type[i] == SiteType::face && site == face;
  };
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) wrong += is_right(i) ? 0 : 1;
  return wrong;
}

}  // namespace sdm::test
