// Writes what engines find into a map.
#pragma once

#include <sdm/map.h>

#include <span>

#include "engine/engine.h"
#include "engine/sign.h"

namespace sdm {

/// Makes room in `map` for the surface, in the memory that it has where that suffices, without values where
/// no face owns a texel; others are unspecified.
void clear(DistanceMap& map, const Surface& surface);

class MapWriter {
 public:
  /// Clears the map. `is_inside` tells which distances are negative; none: null. All must outlive it.
  MapWriter(DistanceMap& map, const Surface& surface, const InsideTest* is_inside);

  /// Stores the closest points of the samples from `first` on. Returns how many have none. Threads may store
  /// different samples at the same time.
  std::size_t store(std::size_t first, const ClosestPacket& closest) const;

 private:
  std::span<const std::uint32_t> texels_;
  std::span<const Vec3> points_;
  const InsideTest* is_inside_;
  DistanceMap& map_;
  // Its arrays.
  float* distance_;
  Vec3f* vector_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm
