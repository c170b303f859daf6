// Clusters of adjacent faces with like normals.
#pragma once

#include <sdm/progress.h>

#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// Few, large, compact charts: every face with an area is in exactly one. Projections of a chart's faces may
/// overlap. Cost: O(n log n).
[[nodiscard]] std::vector<Chart> cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle);

}  // namespace sdm::atlas
