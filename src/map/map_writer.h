// Stores the results of engines in a map.
#pragma once

#include <sdm/map.h>

#include <span>

#include "sites/closest_packet.h"

namespace sdm::map {

/// Makes room in `map` for the surface, in the memory that it has where that suffices, without values where
/// no face owns a texel; others are unspecified.
void clear(DistanceMap& map, const Surface& surface);

class MapWriter {
 public:
  /// Clears the map. Both must outlive it.
  MapWriter(DistanceMap& map, const Surface& surface);

  /// Stores the closest points of the samples from `first` on; `inside` has a bit for each whose distance is
  /// negative. Returns how many have none. Threads may store different samples at the same time.
  std::size_t store(std::size_t first, const sites::ClosestPacket& closest, std::uint32_t inside) const;

 private:
  std::span<const std::uint32_t> texels_;
  DistanceMap& map_;
  // Its arrays.
  float* distance_;
  Vec3f* vector_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm::map
