#include "closest/closest_points.h"

#include <algorithm>
#include <memory>

#include "closest/blocks.h"
#include "closest/descent.h"
#include "closest/finish.h"

namespace sdm::closest {
namespace {

// So few points are searched one at a time: a packet would consist mostly of padding.
constexpr std::size_t kFew = 8;

// The distances of a descent are those of boxes and spheres in the unit frame, in single precision.
constexpr float kBoundError = 1e-6f;

}  // namespace

void closest_points(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                    const sites::ClosestSink& sink) {
  static_assert(PointGroup::kMostPoints >= kLargestBlock, "each block is one group");
  thread_local const auto descent = std::make_unique<Descent>();
  const float limit = sites.frame.unit_limit(max_distance) + kBoundError;
  for (std::size_t begin = 0; begin < points.size(); begin += PointGroup::kMostPoints) {
    const std::span<const Vec3> queries =
        points.subspan(begin, std::min(PointGroup::kMostPoints, points.size() - begin));
    bool some_far_away = false;
    if (queries.size() <= kFew) {
      std::fill_n(descent->winners, PointGroup::kPacket, SiteId::kUnsettled);
    } else {
      some_far_away = descent->points.place(queries, sites.frame);
      find_winners(sites.wide, sites.regions, limit, *descent);
    }
    if (some_far_away)
      for (std::size_t i = 0; i < queries.size(); ++i)
        if (PointGroup::far_away(sites.frame.to_unit(queries[i]))) descent->winners[i] = SiteId::kUnsettled;
    finish(sites, {descent->winners, queries.size()}, queries, max_distance,
           [&](std::size_t first, const sites::ClosestPacket& closest) { sink(begin + first, closest); });
  }
}

}  // namespace sdm::closest
