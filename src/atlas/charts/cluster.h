// Clusters of adjacent faces with similar normals.
#pragma once

#include <sdm/progress.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// Partitions the faces with an area into few, large, compact charts. The projections of a chart's faces may
/// overlap. Returns nothing if the first clusters, each grown about the normal of one face, are `rough` or
/// more. Cost: O(n log n).
[[nodiscard]] std::optional<std::vector<Chart>> cluster_faces(const Mesh& mesh, const FaceGeometry& faces,
                                                              double cos_angle, std::size_t rough = SIZE_MAX);

}  // namespace sdm::atlas
