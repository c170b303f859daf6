/// Distances at the vertices of a mesh.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>

#include <vector>

namespace sdm {

/// Returns the distance from each vertex of `mesh` to O2, NaN beyond options.max_distance; signed as by
/// compute_map with the same options. With options.facing, the normal of a vertex is that of its faces,
/// weighted by their angles. A maps_only engine is replaced by cpu. Throws sdm::Error as closest_points does,
/// and for a sign method that O2 does not allow; Cancelled. Cost: that of closest_points.
[[nodiscard]] SDM_API std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites,
                                                               MapOptions options = {});

}  // namespace sdm
