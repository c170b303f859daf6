#include "scenes/spatial_hash.h"

#include <bit>

namespace sdm::scenes {

// A counting sort: begins_ first holds the counts, then the ends and, once all points are placed, the
// beginnings.
void SpatialHash::fill(std::span<const Vec3> points) {
  begins_.assign(std::bit_ceil(2 * points.size() + 1) + 1, 0);
  sorted_.resize(points.size());
  for (const Vec3& p : points) ++begins_[slot_of(cell_of(p))];
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : begins_) begin = sum += begin;
  for (std::size_t i = points.size(); i-- > 0;)
    sorted_[--begins_[slot_of(cell_of(points[i]))]] = static_cast<std::uint32_t>(i);
}

}  // namespace sdm::scenes
