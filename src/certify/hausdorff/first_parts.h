// The faces of A that may hold the largest distance, given the distances of vertices.
#pragma once

#include <span>
#include <vector>

#include "certify/hausdorff/part.h"
#include "certify/hausdorff/vertex_search.h"

namespace sdm::hausdorff {

struct FirstParts {
  std::vector<Part> parts;  ///< with bounds above lower + precision
  double settled = 0;       ///< bound on the distance everywhere else, unless it is at most `lower`
};

/// Bounds each face of A by faces of B that are near its corners.
[[nodiscard]] FirstParts first_parts(const Mesh& a, const sites::SitesData& b,
                                     std::span<const VertexDistance> vertices, double lower,
                                     double precision);

}  // namespace sdm::hausdorff
