#include "gl/confirm.h"

#include <algorithm>

#include "closest/closest_points.h"
#include "sites/closest_on_face.h"

namespace sdm::gl {

std::size_t confirm(const sites::SitesData& sites, const RasterWinners& winners,
                    std::span<const std::uint32_t> texels, std::span<const Vec3> points, double max_distance,
                    const sites::ClosestSink& sink) {
  std::size_t unconfirmed = 0;
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < texels.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, texels.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const std::uint32_t texel = texels[first + i];
      const bool drawn = texel < winners.winners.size();
      const std::uint32_t face = drawn ? winners.winners[texel] : kNone;
      ClosestPoint closest;
      if (face != kNone) closest = sites::closest_around_face(sites, face, points[first + i]);
      const bool confirmed =
          face == kNone ? drawn && winners.complete : winners.confirms(texel, closest.distance);
      packet.set(i, points[first + i], closest.distance <= max_distance ? closest : ClosestPoint{});
      if (confirmed) continue;
      unconfirmed += drawn;
      closest::closest_points(sites, points.subspan(first + i, 1), max_distance,
                              [&](std::size_t, const sites::ClosestPacket& found) {
                                packet.set(i, points[first + i], found.get(0, points[first + i]));
                              });
    }
    sink(first, packet);
  }
  return unconfirmed;
}

}  // namespace sdm::gl
