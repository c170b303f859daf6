// The faces of A that may hold the largest distance, given the distances of vertices.
#pragma once

#include <sdm/execution.h>

#include <cstdint>
#include <span>
#include <vector>

#include "certify/hausdorff/matching.h"
#include "certify/hausdorff/part.h"
#include "certify/hausdorff/vertex_search.h"

namespace sdm::hausdorff {

struct FirstParts {
  std::vector<FacePart> parts;  ///< with bounds above lower + precision
  double settled = 0;           ///< bound on the distance everywhere else, unless it is at most `lower`
};

/// Bounds each face of A by faces of B that are near its corners.
[[nodiscard]] FirstParts first_parts(const Mesh& a, const sites::SitesData& b,
                                     std::span<const VertexDistance> vertices, double lower,
                                     double precision);

struct MatchedParts : FirstParts {
  std::vector<std::uint32_t> unmatched;  ///< the faces of A that no face of B is allowed for, in their order
};

/// Bounds each face of A by allowed faces near its corners, and raises the lower bound. Faces without a
/// normal are left out. `decides`: the lower bound is a limit, below which any upper bound will do: faces
/// that were found for others are tried before searches. Cost: at most three searches for each face of A; all
/// cores.
[[nodiscard]] MatchedParts matched_parts(const Mesh& a, const sites::SitesData& b, const Matching& matching,
                                         double precision, bool decides, const Progress& progress,
                                         LowerBound& lower);

}  // namespace sdm::hausdorff
