/// What is measured at the samples of a surface, of which programs may choose while they run.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites.
#pragma once

#include <sdm/along.h>
#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/map_samples.h>
#include <sdm/mesh.h>
#include <sdm/self_proximity_query.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/thickness.h>
#include <sdm/vertex_distances.h>

#include <variant>
#include <vector>

namespace sdm {

/// A measure is its options: of the closest point of O2 or, with MapOptions::facing, of the faces that face
/// the same way; along lines; to the rest of the same mesh; of the wall thickness. Of the last two, O2 is the
/// mesh of the surface. DistanceKind says what may be concluded from the samples of each.
using Measure = std::variant<MapOptions, AlongOptions, SelfOptions, ThicknessOptions>;

/// Computes the map of a measure. Errors and cost as of the measure: of MapOptions, those of compute_map() in
/// sdm/map.h.
[[nodiscard]] SDM_API DistanceMap compute_map(const Surface& surface, const Sites& sites,
                                              const Measure& measure);

/// Computes the values of some samples, as compute_samples() in sdm/map_samples.h. Errors as of both. Of
/// measures other than MapOptions, each call costs what they prepare, such as the order of the faces, and
/// linear in texels besides.
SDM_API void compute_samples_of_measure(const Surface& surface, const Sites& sites, const Measure& measure,
                                        const SampleRange& range, DistanceMap& map);

/// Returns the distance at each vertex of `mesh`, O1. Of MapOptions, as in sdm/vertex_distances.h; of other
/// measures, each face around a vertex has a distance there, and the result is that of least absolute value,
/// of the first such face; NaN for a vertex without a value. Errors as of the measure. Cost: a search for
/// each corner of a face, at a vertex once for faces that measure alike; all cores.
[[nodiscard]] SDM_API std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites,
                                                               const Measure& measure);

}  // namespace sdm
