#include <sdm/error.h>
#include <sdm/temporal_maps.h>

#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {

void TemporalMaps::add(const DistanceMap& map) try {
  if (maps_ == 0) {
    resolution_ = map.resolution;
    least_ = largest_ = map.distance;
    sum_.assign(map.distance.begin(), map.distance.end());
  } else if (map.resolution != resolution_) {
    throw Error("a map of " + std::to_string(map.resolution) + "² texels cannot be added to maps of " +
                std::to_string(resolution_) + "²");
  } else {
    parallel_for(sum_.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const float d = map.distance[i];
        sum_[i] += d;  // NaN if either is
        // NaN in either operand makes the minimum and maximum NaN as well.
        if (d < least_[i] || std::isnan(d)) least_[i] = d;
        if (d > largest_[i] || std::isnan(d)) largest_[i] = d;
      }
    });
  }
  ++maps_;
} catch (const std::bad_alloc&) {
  throw out_of_memory("maps over time");
}

std::vector<float> TemporalMaps::mean() const try {
  std::vector<float> mean(sum_.size());
  for (std::size_t i = 0; i < sum_.size(); ++i)
    mean[i] = static_cast<float>(sum_[i] / static_cast<double>(maps_));
  return mean;
} catch (const std::bad_alloc&) {
  throw out_of_memory("maps over time");
}

}  // namespace sdm
