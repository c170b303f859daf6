// Rays of one sample into a hemisphere, for ambient occlusion.
#pragma once

#include <sdm/rays.h>
#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "rays/trace.h"

namespace sdm::rays {

/// Sets `directions` to unit vectors about `normal`, a unit vector, with a density proportional to the cosine
/// of the angle to it: a Hammersley set on the unit disc, shifted at random, raised to the sphere (N.
/// Malley). Each of the n strata of equal area between concentric circles contains one; so do, for n = 2^k,
/// all elementary intervals. The shift depends on seed and index.
void cosine_hemisphere(const Vec3& normal, std::uint64_t seed, std::uint64_t index,
                       std::span<Vec3> directions);

/// Sets `directions` to unit vectors with z ≥ 0, of which every part of the hemisphere has the same density:
/// a Sobol sequence (I. M. Sobol, 1967), shifted at random. Each aligned run of 2^k contains one of all
/// elementary intervals of that size. The shift depends on the seed.
void uniform_hemisphere(std::uint64_t seed, std::span<Vec3> directions);

/// Working memory for the rays of one sample at a time.
class HemisphereRays {
 public:
  explicit HemisphereRays(std::size_t count = 0) { resize(count); }
  void resize(std::size_t count);

  /// The fraction of the rays from a point, in directions of cosine_hemisphere(), that meet nothing. `first`:
  /// a ray of which the direction is replaced.
  [[nodiscard]] float visibility(const sites::SitesData& sites, const Ray& first, const Vec3& normal,
                                 std::uint64_t seed, std::uint32_t texel);

 private:
  std::vector<Vec3> directions_;
  std::vector<Ray> rays_;
  std::vector<std::uint8_t> occluded_;
  Scratch scratch_;
};

}  // namespace sdm::rays
