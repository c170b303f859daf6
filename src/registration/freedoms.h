// How well the surface of O2 determines a rigid motion.
#pragma once

#include <sdm/align.h>

#include "registration/correspondences.h"
#include "registration/eigen.h"

namespace sdm::registration {

/// Below this rms motion along the normals, per unit of motion, a motion is free.
inline constexpr double kFree = 0.02;

/// Orthonormal motions that are not free, by the smooth normals of the usable pairs within `cut`.
[[nodiscard]] Motions determined_motions(const Correspondences& pairs, const Sites& o2, const Pivot& pivot,
                                         double cut);

/// All six, the best determined one first. Free ones are separated into translations and rotations.
/// `deviation`: the standard deviation of the residuals of `count` samples.
[[nodiscard]] std::array<DegreeOfFreedom, 6> degrees_of_freedom(const Correspondences& pairs, const Sites& o2,
                                                                const Pivot& pivot, double cut,
                                                                double deviation, std::size_t count);

}  // namespace sdm::registration
