// Placements of one mesh relative to another.
#pragma once

#include <sdm/sites.h>

#include <random>
#include <vector>

#include "geometry/affine.h"

namespace sdm::bench {

/// A uniformly distributed rotation about the origin.
[[nodiscard]] Affine random_rotation(std::mt19937& random);

/// Relative placements of two meshes.
enum class Stand { far, near, touching, penetrating, deep };
inline constexpr Stand kStands[] = {Stand::far, Stand::near, Stand::touching, Stand::penetrating,
                                    Stand::deep};

/// Rigid poses of O2, with a random rotation and in a random direction from O1, cycling through the stands.
/// With s the mean diagonal of both bounding boxes: far is 0.5 s from touching, near 0.01 s, touching as
/// close as doubles allow without intersecting, penetrating 0.05 s deeper than that, and deep with coinciding
/// centres.
[[nodiscard]] std::vector<Affine> random_poses(const Sites& o1, const Sites& o2, std::size_t count,
                                               std::mt19937& random);

}  // namespace sdm::bench
