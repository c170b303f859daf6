// Directions of a hemisphere, for ambient occlusion.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>

namespace sdm::rays {

/// Sets `directions` to unit vectors about `normal`, a unit vector, with a density proportional to the cosine
/// of the angle to it: a Hammersley set on the unit disc, shifted at random, raised to the sphere (N.
/// Malley). Each of the n strata of equal area between concentric circles contains one; so do, for n = 2^k,
/// all elementary intervals. The shift depends on seed and index.
void cosine_hemisphere(const Vec3& normal, std::uint64_t seed, std::uint64_t index,
                       std::span<Vec3> directions);

}  // namespace sdm::rays
