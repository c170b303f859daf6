// The area of the largest place, for verdicts that depend on it.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <span>

namespace sdm::map {

/// Returns the area of the largest place out of a tolerance by more than the accuracy, or without a value, as
/// of find_places(); 0 without one. If the tolerance is empty (lower > upper), that of all texels. Cost: as
/// of find_places().
[[nodiscard]] double largest_place(const Surface& surface, const DistanceMap& map,
                                   std::span<const float> vertex_distances, const Tolerance& tolerance,
                                   double accuracy);

}  // namespace sdm::map
