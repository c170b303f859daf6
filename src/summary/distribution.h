// The histogram, the bands and the parts of a map.
#pragma once

#include <sdm/summary.h>

namespace sdm::summary {

/// Divides the area by the tolerance, the accuracy, the bands and the names of the options. Throws sdm::Error
/// for bands that do not increase.
[[nodiscard]] Distribution distribution_of(const Surface& surface, const DistanceMap& map,
                                           const DistanceStatistics& distance, const SummaryOptions& options);

}  // namespace sdm::summary
