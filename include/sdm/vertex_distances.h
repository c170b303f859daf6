/// Distances at the vertices of a mesh.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>

#include <cstdint>
#include <vector>

namespace sdm {

/// Returns the distance from each vertex of `mesh` to O2, NaN beyond options.max_distance; signed as by
/// compute_map with the same options. With options.facing, each face around a vertex has a distance there, by
/// its own normal; the result is the one of least absolute value, NaN if no face has one. An engine that
/// takes no points (EngineInfo::takes_points) is replaced by cpu. Throws sdm::Error as closest_points does,
/// and for a sign method that O2 does not allow; Cancelled. Cost: that of closest_points; with
/// options.facing, another search for each face around a vertex whose closest point it does not allow. For
/// other measures, see sdm/measure.h.
[[nodiscard]] SDM_API std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites,
                                                               const MapOptions& options = {});

/// boundary_mask() of the vertices of `mesh`: for each, 1 if its closest site is a boundary edge of an open
/// O2 or a vertex of one, otherwise 0, also beyond options.max_distance. Distances by SignMethod::side have
/// no sign there. Errors and cost as of closest_points().
[[nodiscard]] SDM_API std::vector<std::uint8_t> boundary_vertices(const Mesh& mesh, const Sites& sites,
                                                                  MapOptions options = {});

}  // namespace sdm
