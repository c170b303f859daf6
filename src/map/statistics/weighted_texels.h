// The samples of a map with their areas on the surface as weights.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>

#include <array>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace sdm::map {

/// Samples are divided into parts whose sums are added in order, so that results do not depend on the number
/// of threads.
class WeightedTexels {
 public:
  static constexpr std::size_t kParts = 16;

  /// Both must outlive this. Throws sdm::Error if the map belongs to another surface.
  WeightedTexels(const Surface& surface, const DistanceMap& map);

  /// Calls visit(distance, weight, face) for all samples of a part; the distance is not finite where
  /// there is none. Weights are areas relative to the largest, so that they fit a float for meshes of any
  /// size.
  template <class Visit>
  void for_each(std::size_t part, const Visit& visit) const {
    const std::size_t end = (part + 1) * owners_.size() / kParts;
    for (std::size_t texel = part * owners_.size() / kParts; texel < end; ++texel)
      if (const std::uint32_t face = owners_[texel]; face != kNone)
        visit(distance_[texel], areas_[face], face);
  }

  /// The area that is the weight 1.
  [[nodiscard]] double largest_area() const { return largest_area_; }

  /// Returns add(part) of all parts, added in order. `Sum` needs an operator +=.
  template <class Sum, class Add>
  static Sum sum(const Add& add) {
    std::array<Sum, kParts> parts{};
    parallel_for(kParts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part) parts[part] = add(part);
    });
    for (std::size_t part = 1; part < kParts; ++part) parts[0] += parts[part];
    return std::move(parts[0]);
  }

 private:
  double largest_area_ = 0;
  std::vector<float> areas_;  ///< of a sample of each face
  std::span<const std::uint32_t> owners_;
  const float* distance_;
};

}  // namespace sdm::map
