// Verdicts that depend on the signs of samples which have none.
#pragma once

#include <sdm/map.h>
#include <sdm/tolerance.h>

#include <span>

namespace sdm::summary {

/// Samples at the boundary of an open O2 have no side: their distances by SignMethod::side are |d|. Where
/// only such samples are out of the tolerance, and each by one of the two signs only, a failure becomes
/// Verdict::not_decided. `in_set`: flags of the faces that the verdict is on; empty: all. Cost: none unless a
/// failure depends on signs; then linear, and a search for each vertex.
void withhold_failure_by_missing_signs(ToleranceVerdict& verdict, const Surface& surface, const Sites& sites,
                                       const DistanceMap& map, std::span<const float> vertex_distances,
                                       std::span<const std::uint8_t> in_set, double accuracy);

}  // namespace sdm::summary
