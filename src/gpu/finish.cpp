#include "gpu/finish.h"

#include <algorithm>
#include <cmath>

#include "closest/exact.h"
#include "closest/single_point.h"
#include "core/nothing_found.h"

namespace sdm::gpu {
namespace {

ClosestPoint closest_of(const sites::SitesData& sites, const Vec3& point, const FaceLists& found,
                        std::size_t place, double max_distance, FinishCounts& counts) {
  bool incomplete = false, alone = false;
  for (std::size_t part = 0; part < found.first.size(); ++part) {
    const FaceList& list = found.of(part, place);
    counts.nodes += list.nodes();
    counts.tests += list.tests();
    incomplete |= list.incomplete();
    alone |= list.alone();
  }
  counts.alone += alone ? 1 : 0;
  if (incomplete) {
    counts.incomplete += 1;
    return closest::exact_closest(sites, point, max_distance);
  }
  closest::FirstClosest best(sites, point, max_distance);
  for (std::size_t part = 0; part < found.first.size(); ++part) {
    const FaceList& list = found.of(part, place);
    counts.candidates += list.count();
    for (std::uint32_t i = 0; i < list.count(); ++i)
      best.offer(sites.tree.items[found.first[part] + list.number[i]]);
  }
  return best.result();
}

}  // namespace

void place_points(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                  std::span<QueryPoint> placed) {
  const auto within = static_cast<float>(std::min(1.00001 * max_distance * sites.frame.scale, 1e18));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 unit = sites.frame.to_unit(points[i]);
    bool near = true;
    for (int k = 0; k < 3; ++k) near &= std::abs(unit[k]) <= kFar;
    placed[i].within = near ? within : -1;
    for (int k = 0; k < 3; ++k) placed[i].position[k] = near ? static_cast<float>(unit[k]) : 0;
  }
}

FinishCounts finish(const sites::SitesData& sites, std::span<const Vec3> points,
                    std::span<const QueryPoint> placed, const FaceLists& found, std::size_t first_list,
                    double max_distance, const sites::ClosestSink& sink) {
  FinishCounts counts;
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < points.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, points.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const Vec3& point = points[first + i];
      const ClosestPoint closest =
          placed[first + i].within < 0
              ? closest::closest_point(sites, point, max_distance)
              : closest_of(sites, point, found, first_list + first + i, max_distance, counts);
      if (closest.type == SiteType::none && max_distance == kInfinity) throw_nothing_found();
      packet.set(i, point, closest);
    }
    sink(first, packet);
  }
  return counts;
}

}  // namespace sdm::gpu
