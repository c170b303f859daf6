// Selects the engine that computes a map.
#pragma once

#include <sdm/error.h>
#include <sdm/map.h>

#include "engine/engine.h"

namespace sdm::map {

/// Returns the engine of the options. Throws sdm::Error unless the maximum distance is greater than 0.
[[nodiscard]] inline std::shared_ptr<const Engine> engine_of(const MapOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
  return options.engine ? options.engine : make_engine(engines().front().name);
}

}  // namespace sdm::map
