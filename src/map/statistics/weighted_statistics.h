// Statistics of weighted distances.
#pragma once

#include <sdm/statistics.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "map/statistics/weighted_percentiles.h"

namespace sdm::map {

struct WeightedSums {
  std::size_t texels = 0, negative = 0;
  double area = 0, distance = 0, square = 0, magnitude = 0, negative_area = 0;  // area-weighted
  float least = std::numeric_limits<float>::infinity(), most = -least;

  void add(float d, double weight) {
    ++texels, negative += d < 0;
    area += weight, distance += weight * d, square += weight * d * d, magnitude += weight * std::abs(d);
    negative_area += d < 0 ? weight : 0;
    least = std::min(least, d), most = std::max(most, d);
  }
  void operator+=(const WeightedSums& other) {
    texels += other.texels, negative += other.negative;
    area += other.area, distance += other.distance;
    square += other.square, magnitude += other.magnitude, negative_area += other.negative_area;
    least = std::min(least, other.least), most = std::max(most, other.most);
  }
};

/// `for_each(part, visit)` must call visit(distance, weight) for all finite distances of a part, the same
/// ones each time; parts may be visited concurrently. Cost: linear, all cores.
template <class ForEach>
DistanceStatistics weighted_statistics(std::size_t parts, const ForEach& for_each) {
  std::vector<WeightedSums> of_part(parts);
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      WeightedSums sums;  // not in place: neighbours would share a cache line
      for_each(part, [&](float d, float weight) { sums.add(d, weight); });
      of_part[part] = sums;
    }
  });
  WeightedSums all;
  for (const WeightedSums& part : of_part) all += part;

  DistanceStatistics result{.texels = all.texels, .negative_texels = all.negative};
  if (all.texels == 0) {
    for (double* value : {&result.min, &result.max, &result.mean, &result.rms, &result.stddev, &result.p01,
                          &result.p05, &result.p50, &result.p95, &result.p99, &result.mean_abs,
                          &result.max_abs, &result.p50_abs, &result.p95_abs, &result.p99_abs})
      *value = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  result.negative_area_fraction = all.area > 0 ? all.negative_area / all.area : 0;
  result.min = all.least;
  result.max = all.most;
  result.mean = all.distance / all.area;
  result.rms = std::sqrt(all.square / all.area);
  result.stddev = std::sqrt(std::max(0.0, all.square / all.area - result.mean * result.mean));
  result.mean_abs = all.magnitude / all.area;
  result.max_abs = std::max(std::abs(result.min), std::abs(result.max));

  constexpr std::array kShares{0.01, 0.05, 0.50, 0.95, 0.99};
  const auto signed_values = WeightedPercentiles::find(parts, for_each, kShares);
  result.p01 = signed_values[0], result.p05 = signed_values[1], result.p50 = signed_values[2];
  result.p95 = signed_values[3], result.p99 = signed_values[4];
  result.p50_abs = result.p50, result.p95_abs = result.p95, result.p99_abs = result.p99;
  if (all.negative > 0) {
    const auto for_each_magnitude = [&](std::size_t part, const auto& visit) {
      for_each(part, [&](float d, float weight) { visit(std::abs(d), weight); });
    };
    const auto magnitudes =
        WeightedPercentiles::find(parts, for_each_magnitude, std::span(kShares).subspan(2));
    result.p50_abs = magnitudes[0], result.p95_abs = magnitudes[1], result.p99_abs = magnitudes[2];
  }
  return result;
}

}  // namespace sdm::map
