// The faces of A that may hold the largest distance, if each is measured to faces of its own.
#pragma once

#include <sdm/progress.h>

#include <cstdint>
#include <vector>

#include "certify/hausdorff/first_parts.h"
#include "certify/hausdorff/lower_bound.h"
#include "certify/hausdorff/matching.h"

namespace sdm::hausdorff {

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
