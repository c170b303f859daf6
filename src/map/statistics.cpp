#include <sdm/error.h>
#include <sdm/statistics.h>

#include "core/geometry/vec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sdm {
namespace {

struct WeightedDistance {
  float distance, weight;
};

// The surface area of a texel, |∂p/∂u × ∂p/∂v|, which is the same for all texels of a face; relative to the
// largest, so that it fits a float for meshes of any size.
std::vector<float> texel_areas(const Surface& surface) {
  const auto charts = surface.face_charts();
  std::vector<double> areas(charts.size());
  double largest = 0;
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

void check(const Surface& surface, const DistanceMap& map) {
  if (map.distance.size() != surface.texel_faces().size())
    throw Error("the map belongs to another surface: its number of texels differs");
}

}  // namespace

DistanceStatistics statistics(const Surface& surface, const DistanceMap& map) {
  check(surface, map);
  const auto areas = texel_areas(surface);
  const auto owners = surface.texel_faces();
  std::vector<WeightedDistance> values;
  values.reserve(surface.sample_texels().size());
  DistanceStatistics result;
  double area = 0, sum = 0, squares = 0;
  for (std::size_t texel = 0; texel < owners.size(); ++texel) {
    const float d = map.distance[texel];
    if (owners[texel] == kNone || !std::isfinite(d)) continue;
    const float weight = areas[owners[texel]];
    values.push_back({d, weight});
    result.negative_texels += d < 0;
    area += weight, sum += double{weight} * d, squares += double{weight} * d * d;
  }
  result.texels = values.size();
  if (values.empty()) {
    result.min = result.max = result.mean = result.rms = std::numeric_limits<double>::quiet_NaN();
    result.p50 = result.p95 = result.p99 = result.min;
    return result;
  }
  std::sort(values.begin(), values.end(),
            [](const auto& a, const auto& b) { return a.distance < b.distance; });
  result.min = values.front().distance;
  result.max = values.back().distance;
  result.mean = sum / area;
  result.rms = std::sqrt(squares / area);

  double below = 0;
  auto value = values.begin();
  const auto percentile = [&](double share) {
    while (value + 1 != values.end() && below + value->weight < share * area) below += (value++)->weight;
    return double{value->distance};
  };
  result.p50 = percentile(0.50);
  result.p95 = percentile(0.95);
  result.p99 = percentile(0.99);
  return result;
}

double area_fraction_beyond(const Surface& surface, const DistanceMap& map, double limit) {
  check(surface, map);
  const auto areas = texel_areas(surface);
  const auto owners = surface.texel_faces();
  double area = 0, beyond = 0;
  for (std::size_t texel = 0; texel < owners.size(); ++texel) {
    if (owners[texel] == kNone) continue;
    const double weight = areas[owners[texel]];
    area += weight;
    if (!(std::abs(map.distance[texel]) <= limit)) beyond += weight;  // also if it has no value
  }
  return area > 0 ? beyond / area : 0;
}

}  // namespace sdm
