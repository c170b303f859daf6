/// Closest points of O2 to any points.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/sites.h>

#include <span>
#include <vector>

namespace sdm {

/// Closest points of O2 to any points, in any order, by the same engines. `distance` in the result is
/// unsigned; options.sign is not used. Throws sdm::Error for a coordinate that is NaN or beyond 1e37, for a
/// max_distance that is not positive, or for an engine that computes maps only; Cancelled.
[[nodiscard]] SDM_API std::vector<ClosestPoint> closest_points(const Sites& sites,
                                                               std::span<const Vec3> points,
                                                               const MapOptions& options = {});

}  // namespace sdm
