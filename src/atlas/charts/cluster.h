// Clusters of adjacent faces with similar normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

struct FaceClusters {
  std::size_t first;                         ///< the number of first clusters, each about one face's normal
  std::optional<std::vector<Chart>> charts;  ///< none if the first clusters are too many
};

/// Partitions the faces with an area into few, large, compact charts, unless the first clusters are
/// `too_many` or more. The projections of a chart's faces may overlap. Cost: O(n log n).
[[nodiscard]] FaceClusters cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle,
                                         std::size_t too_many = SIZE_MAX);

}  // namespace sdm::atlas
