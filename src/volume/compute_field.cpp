#include <sdm/volume.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

#include "closest/cpu/cpu_engine.h"
#include "core/memory.h"
#include "volume/field_by_engine.h"

namespace sdm {

DistanceField compute_field(const Sites& sites, const Grid& grid, const FieldOptions& options) {
  FieldReport unused;
  return compute_field(sites, grid, options, unused);
}

DistanceField compute_field(const Sites& sites, const Grid& grid, const FieldOptions& options,
                            FieldReport& report) try {
  const bool only_near = options.max_distance < kInfinity;
  return volume::field_by_engine(sites, grid, options, cpu::CpuEngine(), only_near, report);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a distance field");
}

std::array<double, 2> distance_range(const DistanceField& field) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  double min = kNaN;
  double max = kNaN;
  for (const float d : field.distance) {
    if (std::isnan(d)) continue;
    min = std::isnan(min) ? double{d} : std::min(min, double{d});
    max = std::isnan(max) ? double{d} : std::max(max, double{d});
  }
  return {min, max};
}

}  // namespace sdm
