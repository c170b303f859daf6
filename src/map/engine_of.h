// Selects the engine that computes a map.
#pragma once

#include <sdm/map.h>

#include "closest/engine.h"

namespace sdm::map {

/// Returns the engine of the options. Throws sdm::Error for options out of their ranges.
[[nodiscard]] inline std::shared_ptr<const Engine> engine_of(const MapOptions& options) {
  check_options(options);
  return options.engine ? options.engine : make_engine(engines().front().name);
}

}  // namespace sdm::map
