#include <sdm/error.h>
#include <sdm/volume.h>

#include <limits>
#include <new>

#include "core/memory.h"
#include "engine/cpu/cpu_engine.h"
#include "volume/field_by_engine.h"

namespace sdm {

DistanceField compute_field(const Sites& sites, const Grid& grid, const FieldOptions& options) try {
  const bool has_band = options.band < std::numeric_limits<double>::infinity();
  return volume::field_by_engine(sites, grid, options, cpu::CpuEngine(), has_band);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a distance field");
}

}  // namespace sdm
