/// Statistics of several maps as of one.
///
/// Threads: an object is used by one thread at a time.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>

#include <vector>

namespace sdm {

/// Collects the distances of maps, such as those of the UDIM tiles of a mesh, with their areas: the maps need
/// not be kept.
class SDM_API CombinedStatistics {
 public:
  /// Throws sdm::Error, and changes nothing, if the map does not belong to this surface, or if there is not
  /// enough memory. Cost:
  /// linear in texels; 8 bytes for each texel with a value.
  void add(const Surface& surface, const DistanceMap& map);

  /// As statistics(), over the texels of all maps, each weighted by its area on its surface. Throws
  /// sdm::Error if there is not enough memory. Cost: linear in texels, all cores.
  [[nodiscard]] DistanceStatistics statistics() const;

 private:
  struct Texel {
    float distance, area;
  };
  std::vector<Texel> texels_;
  double unit_ = 0;  ///< of the areas: that of the largest texel of the first map
};

}  // namespace sdm
