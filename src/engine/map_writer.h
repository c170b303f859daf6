// Writes what engines find into a map.
#pragma once

#include <sdm/map.h>

#include <span>

#include "engine/engine.h"
#include "engine/sign.h"

namespace sdm {

class MapWriter {
 public:
  /// Makes room in `map` for the surface, in the memory that it has where that suffices, without values where
  /// no face owns a texel. `is_inside` tells which distances are negative; none: null. All must outlive it.
  MapWriter(DistanceMap& map, const Surface& surface, const InsideTest* is_inside);

  /// Stores the closest points of the samples from `first` on. Returns how many have none. Threads may store
  /// different samples at the same time.
  std::size_t store(std::size_t first, const ClosestPacket& closest) const;

 private:
  void store_none(std::size_t texel, std::size_t count) const;

  std::span<const std::uint32_t> texels_;
  std::span<const Vec3> points_;
  const InsideTest* is_inside_;
  // The arrays of the map.
  float* distance_;
  Vec3f* vector_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm
