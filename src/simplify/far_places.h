// Where a simplified mesh is farther from the input than a limit.
#pragma once

#include <sdm/execution.h>
#include <sdm/sites.h>

#include <cstdint>
#include <vector>

namespace sdm::simplify {

/// Vertices of the result near which a point of either surface is farther than the limit from the other one,
/// the witness of the deviation among these; if no such point is known, those near parts that may have one.
[[nodiscard]] std::vector<std::uint32_t> far_places(const Sites& input, const Mesh& result, double limit,
                                                    const Progress& progress);

}  // namespace sdm::simplify
