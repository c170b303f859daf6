// How well the surface of O2 determines a rigid motion.
#pragma once

#include <sdm/align.h>

#include "registration/correspondences.h"
#include "registration/eigen.h"

namespace sdm::registration {

/// Below this rms motion along the normals, per unit of motion, a motion is free.
inline constexpr double kFree = 0.02;

/// Orthonormal motions in the span of the orthonormal `allowed` that are not free, by the smooth normals of
/// the usable pairs within `cut`.
[[nodiscard]] Motions determined_motions(const Correspondences& pairs, const Sites& o2, const Pivot& pivot,
                                         double cut, const Motions& allowed);

/// All six, the best determined one first, and those that are not allowed last. Free ones are separated into
/// translations and rotations. `deviation`: the standard deviation of the residuals of `count` samples.
[[nodiscard]] std::array<DegreeOfFreedom, 6> degrees_of_freedom(const Correspondences& pairs, const Sites& o2,
                                                                const Pivot& pivot, double cut,
                                                                double deviation, std::size_t count,
                                                                const Motions& allowed);

}  // namespace sdm::registration
