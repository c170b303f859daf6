#include <sdm/error.h>
#include <sdm/statistics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "map/weighted_percentiles.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

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

// Texels are divided into parts whose sums are added in order, so that results do not depend on the number of
// threads.
constexpr std::size_t kParts = 16;

struct Sums {
  std::size_t texels = 0, negative = 0;
  double area = 0, distance = 0, square = 0, magnitude = 0;  // area-weighted
  float least = std::numeric_limits<float>::infinity(), most = -least;

  void add(float d, double weight) {
    ++texels, negative += d < 0;
    area += weight, distance += weight * d, square += weight * d * d, magnitude += weight * std::abs(d);
    least = std::min(least, d), most = std::max(most, d);
  }
  void add(const Sums& other) {
    texels += other.texels, negative += other.negative;
    area += other.area, distance += other.distance;
    square += other.square, magnitude += other.magnitude;
    least = std::min(least, other.least), most = std::max(most, other.most);
  }
};

void check(const Surface& surface, const DistanceMap& map) {
  if (map.distance.size() != surface.texel_faces().size())
    throw Error("the map belongs to another surface: its number of texels differs");
}

}  // namespace

DistanceStatistics statistics(const Surface& surface, const DistanceMap& map) {
  check(surface, map);
  const auto areas = texel_areas(surface);
  const auto owners = surface.texel_faces();
  // visit(distance, weight) for all texels of a part that have a value.
  const auto for_each = [&](std::size_t part, const auto& visit) {
    const std::size_t end = (part + 1) * owners.size() / kParts;
    for (std::size_t texel = part * owners.size() / kParts; texel < end; ++texel)
      if (const float d = map.distance[texel]; owners[texel] != kNone && std::isfinite(d))
        visit(d, areas[owners[texel]]);
  };
  std::array<Sums, kParts> parts;
  parallel_for(kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for_each(part, [&sums = parts[part]](float d, float weight) { sums.add(d, weight); });
  });
  Sums all;
  for (const Sums& part : parts) all.add(part);

  DistanceStatistics result{.texels = all.texels, .negative_texels = all.negative};
  if (all.texels == 0) {
    result.min = result.max = result.mean = result.rms = std::numeric_limits<double>::quiet_NaN();
    result.stddev = result.p50 = result.p95 = result.p99 = result.min;
    result.mean_abs = result.p50_abs = result.p95_abs = result.p99_abs = result.min;
    return result;
  }
  result.min = all.least;
  result.max = all.most;
  result.mean = all.distance / all.area;
  result.rms = std::sqrt(all.square / all.area);
  result.stddev = std::sqrt(std::max(0.0, all.square / all.area - result.mean * result.mean));
  result.mean_abs = all.magnitude / all.area;

  constexpr std::array kShares{0.50, 0.95, 0.99};
  const auto signed_values = map::WeightedPercentiles::find(kParts, for_each, kShares);
  result.p50 = signed_values[0], result.p95 = signed_values[1], result.p99 = signed_values[2];
  const auto for_each_magnitude = [&](std::size_t part, const auto& visit) {
    for_each(part, [&](float d, float weight) { visit(std::abs(d), weight); });
  };
  const auto magnitudes =
      all.negative == 0 ? signed_values : map::WeightedPercentiles::find(kParts, for_each_magnitude, kShares);
  result.p50_abs = magnitudes[0], result.p95_abs = magnitudes[1], result.p99_abs = magnitudes[2];
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
  const auto owners = surface.texel_faces();
  for (std::size_t texel = 0; texel < owners.size(); ++texel) {
    const double d = map.distance[texel];
    if (owners[texel] == kNone || std::isinf(d)) continue;
    if (less(d)) result.min.distance = d, least = texel;
    if (greater(d)) result.max.distance = d, most = texel;
  }
  const auto place = [&](Extreme& extreme, std::size_t texel) {
    if (!std::isnan(extreme.distance)) extreme.point = surface.texel_point(static_cast<std::uint32_t>(texel));
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
