// Verdicts that depend on the signs of samples which have none.
#pragma once

#include <sdm/map.h>
#include <sdm/tolerance.h>

#include <span>

#include "summary/verdict/evidence.h"

namespace sdm::summary {

/// Samples at the boundary of an open O2 have no side: their distances by SignMethod::side are |d|. Where
/// only such samples of a group are out of its tolerance, and each by one of the two signs only, a failure
/// becomes Verdict::not_decided. `verdicts`: one for each group. Cost: none unless a failure depends on
/// signs; then linear for all groups together, and a search for each vertex.
void withhold_failures_by_missing_signs(std::span<ToleranceVerdict> verdicts, const FaceGroups& groups,
                                        const Surface& surface, const Sites& sites, const DistanceMap& map,
                                        std::span<const float> vertex_distances, double accuracy);

}  // namespace sdm::summary
