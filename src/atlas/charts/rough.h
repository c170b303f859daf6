// Charts that do not follow noise: of surfaces that are rough at the scale of their faces, as scans are.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

struct Clusters {
  std::vector<Chart> charts;
  bool rough = false;  ///< by noise: many of the charts are of one face or a few
};

/// As cluster_faces() does. But where a surface is so rough that charts would have few texels at this
/// resolution, is less so when it is smoothed, and `cos_angle` is that of 25° or more, its charts are those
/// of smoothed normals: the normals of their faces are within 75.5° of the axis, and all but few of them
/// within less. Faces that are steeper, or that overlap in a fold, form charts of their own. Cost: O(n log
/// n).
[[nodiscard]] Clusters cluster_rough_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle,
                                           std::uint32_t resolution);

}  // namespace sdm::atlas
