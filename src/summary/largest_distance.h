// Bounds on the largest distance of all points of a surface, from those of its samples.
#pragma once

#include <sdm/summary.h>

namespace sdm::summary {

/// Bounds the largest distance by the extremes and the evidence of the summary.
[[nodiscard]] LargestDistance largest_distance(const Summary& summary);

}  // namespace sdm::summary
