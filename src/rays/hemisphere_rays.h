// Rays of one sample into a hemisphere, for ambient occlusion.
#pragma once

#include <sdm/rays.h>

#include <cstdint>
#include <vector>

#include "rays/trace.h"

namespace sdm::rays {

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
