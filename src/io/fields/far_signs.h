// The signs of points beyond the maximum distance of a signed field.
#pragma once

#include <sdm/volume.h>

#include <vector>

namespace sdm::io {

/// Whether points without a value are known to be inside or outside: in a signed field with a maximum
/// distance of at least the largest spacing.
[[nodiscard]] bool has_far_signs(const DistanceField& field);

/// Returns for each point of such a field whether it is inside. Two neighbours of a grid on different sides
/// of O2 are both within their spacing of it, and so have values; a point without a value is therefore on the
/// side of any of its neighbours. Cost: linear.
[[nodiscard]] std::vector<bool> far_signs(const DistanceField& field);

}  // namespace sdm::io
