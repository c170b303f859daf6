// Pairs of adjacent faces, for atlases without distortion.
#pragma once

#include <sdm/mesh.h>

#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// Charts of two faces each, unfolded across an edge that they share, preferably a long one; faces that are
/// left over are charts of their own. Every face with an area is in one chart. Deterministic. Cost: O(n).
[[nodiscard]] std::vector<Chart> pair_faces(const Mesh& mesh, const FaceGeometry& faces);

}  // namespace sdm::atlas
