// Distance fields by any engine that finds closest points.
#pragma once

#include <sdm/volume.h>

#include "closest/engine.h"

namespace sdm::volume {

/// Does what sdm::compute_field does, by an engine. With `only_near`, points that are surely beyond the
/// maximum distance are skipped.
[[nodiscard]] DistanceField field_by_engine(const Sites& sites, const Grid& grid, const FieldOptions& options,
                                            const Engine& engine, bool only_near, FieldReport& report);

}  // namespace sdm::volume
