#include "map/statistics/weighted_texels.h"

#include <sdm/error.h>

#include <algorithm>

#include "map/statistics/texel_areas.h"

namespace sdm::map {
namespace {

// The area of a sample of each face, relative to the `largest`.
std::vector<float> relative_areas(const Surface& surface, double& largest) {
  const std::vector<double> areas = texel_areas(surface);
  largest = areas.empty() ? 0 : *std::ranges::max_element(areas);
  std::vector<float> relative(areas.size());
  std::transform(areas.begin(), areas.end(), relative.begin(),
                 [&](double area) { return static_cast<float>(area / largest); });
  return relative;
}

}  // namespace

WeightedTexels::WeightedTexels(const Surface& surface, const DistanceMap& map)
    : owners_(surface.map_faces()), distance_(map.distance.data()) {
  if (map.distance.size() != owners_.size())
    throw Error("the map belongs to another surface: its number of texels differs");
  areas_ = relative_areas(surface, largest_area_);
}

}  // namespace sdm::map
