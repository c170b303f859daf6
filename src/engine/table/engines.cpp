#include <sdm/error.h>

#include "engine/cpu/cpu_engine.h"
#include "engine/engine.h"
#include "engine/reference/reference_engine.h"

namespace sdm::engine {

ClosestSearch search_of(EngineKind engine) {
  if (engine == EngineKind::gl)
    throw Error("the gl engine computes maps only: for closest points choose cpu or reference");
  return engine == EngineKind::reference ? reference::reference_search : cpu::cpu_search;
}

}  // namespace sdm::engine
