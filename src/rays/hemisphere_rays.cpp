#include "rays/hemisphere_rays.h"

#include <algorithm>

#include "rays/hemisphere.h"

namespace sdm::rays {

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
