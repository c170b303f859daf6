#include "rays/hemisphere_rays.h"

#include <sdm/error.h>

#include <algorithm>
#include <string>

#include "rays/hemisphere.h"

namespace sdm::rays {

void check_options(const AmbientOcclusionOptions& options, const char* function) {
  constexpr std::uint32_t kMostRays = 1 << 16;
  if (options.rays < 1 || options.rays > kMostRays)
    throw Error(std::string(function) + "() needs 1 to 65536 rays for each sample");
  if (!(options.max_distance > 0))
    throw Error(std::string(function) + "() needs a max_distance greater than 0");
}

void HemisphereRays::resize(std::size_t count) {
  directions_.resize(count);
  rays_.resize(count);
  occluded_.resize(count);
}

float HemisphereRays::visibility(const sites::SitesData& sites, const Ray& first, const Vec3& normal,
                                 std::uint64_t seed, std::uint32_t texel) {
  cosine_hemisphere(normal, seed, texel, directions_);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    rays_[i] = first;
    rays_[i].direction = directions_[i];
  }
  occluded(sites, rays_, scratch_, occluded_.data());
  const auto hits = std::count(occluded_.begin(), occluded_.end(), 1);
  return static_cast<float>(1 - static_cast<double>(hits) / static_cast<double>(rays_.size()));
}

}  // namespace sdm::rays
