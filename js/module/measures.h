// What the maps of JavaScript measure.
#pragma once

#include <sdm/map.h>
#include <sdm/mesh.h>

#include <span>

#include "module/options.h"

namespace sdm::js {

/// The options of a map, and the positions of the mesh at rest, if they were given.
struct GivenMeasure {
  GivenOptions options;
  std::span<const Vec3> rest;
};

/// Computes a map. Throws sdm::Error for a measure that this module does not have: the large one has all of
/// sdm/measure.h, the other one those of MapOptions.
void measure(const Surface& surface, const Sites& sites, const GivenMeasure& given, DistanceMap& map);
/// The same of some samples, as compute_samples() does.
void measure_samples(const Surface& surface, const Sites& sites, const GivenMeasure& given,
                     const SampleRange& range, DistanceMap& map);

}  // namespace sdm::js
