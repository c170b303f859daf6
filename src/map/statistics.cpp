#include <sdm/error.h>
#include <sdm/statistics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/geometry/vec.h"
#include "surface/surface_data.h"

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
  double area = 0, sum = 0, squares = 0, magnitudes = 0;
  for (std::size_t texel = 0; texel < owners.size(); ++texel) {
    const float d = map.distance[texel];
    if (owners[texel] == kNone || !std::isfinite(d)) continue;
    const float weight = areas[owners[texel]];
    values.push_back({d, weight});
    result.negative_texels += d < 0;
    area += weight, sum += double{weight} * d, squares += double{weight} * d * d;
    magnitudes += double{weight} * std::abs(d);
  }
  result.texels = values.size();
  if (values.empty()) {
    result.min = result.max = result.mean = result.rms = std::numeric_limits<double>::quiet_NaN();
    result.stddev = result.p50 = result.p95 = result.p99 = result.min;
    result.mean_abs = result.p50_abs = result.p95_abs = result.p99_abs = result.min;
    return result;
  }
  std::ranges::sort(values, {}, &WeightedDistance::distance);
  result.min = values.front().distance;
  result.max = values.back().distance;
  result.mean = sum / area;
  result.rms = std::sqrt(squares / area);

  result.stddev = std::sqrt(std::max(0.0, squares / area - result.mean * result.mean));
  result.mean_abs = magnitudes / area;
  const auto percentiles = [&](double& p50, double& p95, double& p99) {
    double below = 0;
    auto value = values.begin();
    for (const auto& [share, to] : {std::pair{0.50, &p50}, std::pair{0.95, &p95}, std::pair{0.99, &p99}}) {
      while (value + 1 != values.end() && below + value->weight < share * area) below += (value++)->weight;
      *to = value->distance;
    }
  };
  percentiles(result.p50, result.p95, result.p99);
  if (result.negative_texels > 0) {
    for (WeightedDistance& value : values) value.distance = std::abs(value.distance);
    std::ranges::sort(values, {}, &WeightedDistance::distance);
  }
  percentiles(result.p50_abs, result.p95_abs, result.p99_abs);
  return result;
}

Extremes extremes(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances) {
  check(surface, map);
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("extremes() needs one distance for each vertex of the surface's mesh");
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Extremes result{.min = {.distance = kNan}, .max = {.distance = kNan}};
  // Returns whether it is a new extreme; comparisons with NaN are false.
  const auto less = [&](double d) { return !(result.min.distance <= d) && !std::isnan(d); };
  const auto greater = [&](double d) { return !(result.max.distance >= d) && !std::isnan(d); };
  std::size_t least = 0, most = 0;
  const std::span<const std::uint32_t> texels = surface.sample_texels();
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const double d = map.distance[texels[i]];
    if (std::isinf(d)) continue;
    if (less(d)) result.min.distance = d, least = i;
    if (greater(d)) result.max.distance = d, most = i;
  }
  const auto place = [&](Extreme& extreme, std::size_t sample) {
    if (!std::isnan(extreme.distance)) internals(surface).place_samples(sample, {&extreme.point, 1});
  };
  place(result.min, least), place(result.max, most);
  for (const Triangle& triangle : surface.mesh().triangles)
    for (const std::uint32_t v : triangle) {
      const double d = vertex_distances[v];
      if (std::isinf(d)) continue;
      if (less(d)) result.min = {d, surface.mesh().positions[v], true};
      if (greater(d)) result.max = {d, surface.mesh().positions[v], true};
    }
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
