// Fields by an engine: closest points of the points of a grid.
#pragma once

#include "closest/engine.h"
#include "volume/field_writer.h"

namespace sdm::volume {

/// Finds the closest sites of all points by the engine; signed, if asked for. With `only_near`, points that
/// are surely beyond the maximum distance are skipped: cells of neighbouring points whose centre is farther
/// from O2 than the maximum distance and the radius of the cell. Returns the bytes of working memory, an
/// estimate.
std::size_t query_grid(const FieldTask& task, const Engine& engine, bool only_near, DistanceField& field);

}  // namespace sdm::volume
