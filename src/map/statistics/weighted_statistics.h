// Statistics of weighted distances.
#pragma once

#include <sdm/statistics.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "core/parallel.h"
#include "map/statistics/weighted_percentiles.h"

namespace sdm::map {

struct WeightedSums {
  std::size_t texels = 0, negative = 0;
  double area = 0, distance = 0, square = 0, magnitude = 0, negative_area = 0;  // area-weighted
  float least = std::numeric_limits<float>::infinity(), most = -least;

  void add(float d, double weight) {
    ++texels;
    negative += d < 0;
    area += weight;
    distance += weight * d;
    square += weight * d * d;
    magnitude += weight * std::abs(d);
    negative_area += d < 0 ? weight : 0;
    least = std::min(least, d);
    most = std::max(most, d);
  }
  void operator+=(const WeightedSums& other) {
    texels += other.texels;
    negative += other.negative;
    area += other.area;
    distance += other.distance;
    square += other.square;
    magnitude += other.magnitude;
    negative_area += other.negative_area;
    least = std::min(least, other.least);
    most = std::max(most, other.most);
  }
};

/// The shares of the weight whose distances are part of statistics, and those of magnitudes.
inline constexpr std::array kShares{0.01, 0.05, 0.50, 0.95, 0.99, 0.999};
inline constexpr std::array kMagnitudeShares{0.50, 0.95, 0.99, 0.999};

/// The statistics of `all` distances. `percentiles(magnitudes, shares)`: the distances, or their magnitudes.
template <class Percentiles>
DistanceStatistics statistics_of(const WeightedSums& all, const Percentiles& percentiles) {
  DistanceStatistics result{.texels = all.texels, .negative_texels = all.negative};
  if (all.texels == 0) {
    for_each_field<DistanceStatistics>([&](const auto& field) {
      if constexpr (std::is_same_v<decltype(result.*field.member), double&>)
        result.*field.member = std::numeric_limits<double>::quiet_NaN();
    });
    result.negative_area_fraction = 0;
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
  const std::vector<float> values = percentiles(false, std::span(kShares)),
                           magnitudes = all.negative > 0 ? percentiles(true, std::span(kMagnitudeShares))
                                                         : std::vector(values.begin() + 2, values.end());
  result.p01 = values[0];
  result.p05 = values[1];
  result.p50 = values[2];
  result.p95 = values[3];
  result.p99 = values[4];
  result.p50_abs = magnitudes[0];
  result.p95_abs = magnitudes[1];
  result.p99_abs = magnitudes[2];
  result.p999_abs = magnitudes[3];
  return result;
}

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
  return statistics_of(all, [&](bool magnitudes, std::span<const double> shares) {
    const auto for_each_value = [&](std::size_t part, const auto& visit) {
      for_each(part, [&](float d, float weight) { visit(magnitudes ? std::abs(d) : d, weight); });
    };
    return WeightedPercentiles::find(parts, for_each_value, shares);
  });
}

}  // namespace sdm::map
