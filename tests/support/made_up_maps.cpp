#include "support/made_up_maps.h"

#include <cmath>
#include <limits>

namespace sdm::test {

DistanceMap map_of(const Surface& surface, const Field& field) {
  DistanceMap map;
  map.resolution = surface.resolution();
  const std::size_t texels = surface.map_faces().size();
  map.without_texel = texels - surface.texel_faces().size();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  map.distance.assign(texels, kNaN);
  map.vector.assign(texels, {kNaN, kNaN, kNaN});
  map.site.assign(texels, kNone);
  map.site_type.assign(texels, SiteType::none);
  map.sign = {SignMethod::exact, "made up"};
  for (const std::uint32_t texel : surface.sample_texels()) {
    const double d = field(surface.texel_point(texel));
    if (std::isnan(d)) {
      ++map.beyond_max_distance;
      continue;
    }
    map.distance[texel] = static_cast<float>(d);
    if (std::isinf(d)) {
      ++map.beyond_max_distance;
      map.vector[texel] = {0, 0, 0};
      continue;
    }
    map.vector[texel] = {static_cast<float>(d), static_cast<float>(texel),
                         -1.f / static_cast<float>(texel + 1)};
    map.site[texel] = texel;
    map.site_type[texel] = static_cast<SiteType>(texel % 3);
  }
  return map;
}

std::vector<float> at_vertices(const Mesh& mesh, const Field& field) {
  std::vector<float> result;
  for (const Vec3& p : mesh.positions) result.push_back(static_cast<float>(field(p)));
  return result;
}

}  // namespace sdm::test
