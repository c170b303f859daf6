// Stores what measures find in a map.
#pragma once

#include <sdm/map.h>

#include <limits>
#include <span>

#include "sites/closest_packet.h"

namespace sdm::map {

/// Resizes `map` for the surface, reusing its memory where possible. Texels that no face owns get no value;
/// all others are unspecified.
void clear(DistanceMap& map, const Surface& surface);

/// The same, but no texel has a value.
void clear_all(DistanceMap& map, const Surface& surface);

/// What measured texels without a closest point hold.
struct NoValue {
  float distance = std::numeric_limits<float>::quiet_NaN();
  float vector = std::numeric_limits<float>::quiet_NaN();  ///< each component
};

class MapWriter {
 public:
  /// The map has the size of the surface's atlas, by clear(), and must outlive this.
  explicit MapWriter(DistanceMap& map, const NoValue& no_value = {});

  /// Stores the closest points of the first texels, of which those behind are stored soon after; bit i of
  /// `inside` is set if the distance of texel i is negative. Returns the number of texels without a closest
  /// point. Threads may store different texels concurrently.
  std::size_t store(std::span<const std::uint32_t> texels, const sites::ClosestPacket& closest,
                    std::uint32_t inside) const;

 private:
  DistanceMap& map_;
  NoValue no_value_;
  // The arrays of map_.
  float* distance_;
  Vec3f* vector_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm::map
