// Stores the engines' results in a map.
#pragma once

#include <sdm/map.h>

#include <span>

#include "sites/closest_packet.h"

namespace sdm::map {

/// Resizes `map` for the surface, reusing its memory where possible. Texels that no face owns get no value;
/// all others are unspecified.
void clear(DistanceMap& map, const Surface& surface);

/// The same, but no texel has a value.
void clear_all(DistanceMap& map, const Surface& surface);

class MapWriter {
 public:
  /// The map has the size of the surface's atlas, by clear(). Both must outlive this.
  MapWriter(DistanceMap& map, const Surface& surface);

  /// Stores the closest points of the samples from `first` on; bit i of `inside` is set if the distance of
  /// sample first + i is negative. Returns the number of samples without a closest point. Threads may store
  /// different samples concurrently.
  std::size_t store(std::size_t first, const sites::ClosestPacket& closest, std::uint32_t inside) const;

 private:
  std::span<const std::uint32_t> texels_;
  DistanceMap& map_;
  // The arrays of map_.
  float* distance_;
  Vec3f* vector_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm::map
