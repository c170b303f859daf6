#include "closest/reference/reference_engine.h"

#include <algorithm>

#include "closest/reference/reference_closest.h"

namespace sdm::reference {

void ReferenceEngine::closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                                     const sites::ClosestSink& sink) const {
  sites::ClosestPacket closest;
  for (std::size_t first = 0; first < points.size(); first += sites::ClosestPacket::kSize) {
    closest.count = std::min(sites::ClosestPacket::kSize, points.size() - first);
    for (std::size_t i = 0; i < closest.count; ++i)
      closest.set(i, points[first + i], reference_closest(internals(sites), points[first + i], max_distance));
    sink(first, closest);
  }
}

}  // namespace sdm::reference
