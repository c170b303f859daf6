/// Statistics over time of the maps of one surface.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>

#include <cstddef>
#include <span>
#include <vector>

namespace sdm {

/// For every texel of a fixed atlas: the minimum, maximum and mean distance over the added maps. NaN where no
/// face owns the texel, or where it was beyond the maximum distance in one of the maps. Self maps mark the
/// latter by +∞ instead: the minimum is then that over the other maps.
class SDM_API TemporalMaps {
 public:
  /// Adds a map. Throws sdm::Error if its resolution differs from that of earlier maps. Cost: O(n) in texels,
  /// all cores.
  void add(const DistanceMap& map);

  [[nodiscard]] std::size_t maps() const { return maps_; }
  [[nodiscard]] std::uint32_t resolution() const { return resolution_; }
  [[nodiscard]] std::span<const float> least() const { return least_; }
  [[nodiscard]] std::span<const float> largest() const { return largest_; }
  /// Cost: O(n) in texels.
  [[nodiscard]] std::vector<float> mean() const;

 private:
  std::size_t maps_ = 0;
  std::uint32_t resolution_ = 0;
  std::vector<float> least_, largest_;
  std::vector<double> sum_;
};

}  // namespace sdm
