// Clusters of adjacent faces with similar normals.
#pragma once

#include <sdm/progress.h>

#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// Partitions the faces with an area into few, large, compact charts. The projections of a chart's faces may
/// overlap. Cost: O(n log n).
[[nodiscard]] std::vector<Chart> cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle);

}  // namespace sdm::atlas
