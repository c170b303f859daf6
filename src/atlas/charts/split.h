// Charts whose projections do not overlap themselves.
#pragma once

#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// Cuts charts in two until the interiors of no two faces of a chart intersect in its projection. The test is
/// exact for the projection snapped to a grid of 2^29 steps across the chart. Faces flipped by the snapping
/// become charts of their own. Cost: linear for faces of similar size and few overlaps, in parallel over
/// charts.
[[nodiscard]] std::vector<Chart> split_overlaps(const Mesh& mesh, const FaceGeometry& faces,
                                                std::vector<Chart> charts);

}  // namespace sdm::atlas
