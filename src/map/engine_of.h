// Selects the engine that computes a map.
#pragma once

#include <sdm/closest_points.h>
#include <sdm/map.h>

#include "closest/engine.h"

namespace sdm::map {

/// Returns the engine of the options. Throws sdm::Error for options out of their ranges.
template <class Options>
[[nodiscard]] std::shared_ptr<const Engine> engine_of(const Options& options) {
  check_options(options);
  return options.engine ? options.engine : make_engine(engines().front().name);
}

/// Returns what a search for closest points has of the options of a map.
[[nodiscard]] inline ClosestPointOptions point_options(const MapOptions& options) {
  return {.engine = options.engine, .max_distance = options.max_distance, .progress = options.progress};
}

}  // namespace sdm::map
