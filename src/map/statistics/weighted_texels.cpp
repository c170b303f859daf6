#include "map/statistics/weighted_texels.h"

#include <sdm/error.h>

#include <algorithm>

#include "geometry/vec.h"
#include "surface/surface_data.h"

namespace sdm::map {
namespace {

// The surface area of a texel, |∂p/∂u × ∂p/∂v|, which is the same for all texels of a face; relative to the
// `largest`.
std::vector<float> texel_areas(const Surface& surface, double& largest) {
  const auto charts = surface.face_charts();
  std::vector<double> areas(charts.size());
  largest = 0;
  for (std::uint32_t face = 0; face < charts.size(); ++face) {
    if (charts[face] == kNone) continue;
    const auto [du, dv] = surface.texel_edges(face);
    areas[face] = norm(cross(du, dv));
    largest = std::max(largest, areas[face]);
  }
  std::vector<float> relative(areas.size());
  std::transform(areas.begin(), areas.end(), relative.begin(),
                 [&](double area) { return static_cast<float>(area / largest); });
  return relative;
}

}  // namespace

WeightedTexels::WeightedTexels(const Surface& surface, const DistanceMap& map)
    : owners_(surface.texel_faces()), distance_(map.distance.data()) {
  if (map.distance.size() != owners_.size())
    throw Error("the map belongs to another surface: its number of texels differs");
  areas_ = texel_areas(surface, largest_area_);
}

}  // namespace sdm::map
