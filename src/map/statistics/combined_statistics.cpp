#include <sdm/statistics.h>

#include <cmath>
#include <new>

#include "core/memory.h"
#include "map/statistics/weighted_statistics.h"
#include "map/statistics/weighted_texels.h"

namespace sdm {

void CombinedStatistics::add(const Surface& surface, const DistanceMap& map) try {
  const map::WeightedTexels texels(surface, map);
  const double unit = unit_ == 0 ? texels.largest_area() : unit_;
  const double scale = unit > 0 ? texels.largest_area() / unit : 1;
  const std::size_t before = texels_.size();
  try {
    for (std::size_t part = 0; part < map::WeightedTexels::kParts; ++part)
      texels.for_each(part, [&](float d, float weight, std::uint32_t) {
        if (std::isfinite(d)) texels_.push_back({d, static_cast<float>(scale * weight)});
      });
  } catch (...) {
    texels_.resize(before);
    throw;
  }
  unit_ = unit;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the statistics of several maps");
}

DistanceStatistics CombinedStatistics::statistics() const try {
  constexpr std::size_t kParts = map::WeightedTexels::kParts;
  return map::weighted_statistics(kParts, [&](std::size_t part, const auto& visit) {
    const std::size_t end = (part + 1) * texels_.size() / kParts;
    for (std::size_t i = part * texels_.size() / kParts; i < end; ++i)
      visit(texels_[i].distance, texels_[i].area);
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("the statistics of several maps");
}

}  // namespace sdm
