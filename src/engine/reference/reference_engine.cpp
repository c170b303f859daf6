// The reference engine: one query at a time, plain enough to be believed.
#include <algorithm>
#include <queue>

#include "core/vec.h"
#include "engine/reference/reference_engine.h"
#include "sites/closest_on_face.h"

namespace sdm::reference {
namespace {

// The distance of a point of the unit frame to a box, less what double rounding may have added to it.
double lower_bound(const hierarchy::FloatBox& box, const Vec3& p) {
  Vec3 gap;
  for (int k = 0; k < 3; ++k) gap[k] = std::max({box.lo[k] - p[k], p[k] - box.hi[k], 0.0});
  return (1 - 1e-12) * norm(gap);
}

}  // namespace

ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q, double max_distance) {
  struct Open {
    double bound;
    std::uint32_t node;
    bool operator<(const Open& other) const { return bound > other.bound; }  // nearest on top
  };
  const Vec3 unit = sites.frame.to_unit(q);
  ClosestPoint best;
  best.distance = max_distance;
  std::priority_queue<Open> open;
  open.push({0, 0});
  // A node is opened even when its bound equals the best distance: O2 may lie at max_distance exactly.
  while (!open.empty() && open.top().bound <= best.distance * sites.frame.scale) {
    const hierarchy::AabbTree::Node& node = sites.tree.nodes[open.top().node];
    const std::uint32_t left = open.top().node + 1;
    open.pop();
    if (node.leaf()) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const ClosestPoint c = sites::closest_on_face(sites, sites.tree.items[i], q);
        if (c.distance < best.distance || (best.type == SiteType::none && c.distance <= max_distance))
          best = c;
      }
    } else {
      for (std::uint32_t child : {left, node.right})
        open.push({lower_bound(sites.tree.nodes[child].box, unit), child});
    }
  }
  if (best.type == SiteType::none) best.distance = std::numeric_limits<double>::infinity();
  return best;
}

void ReferenceEngine::closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                                     const ClosestSink& sink) const {
  sites::ClosestPacket closest;
  for (std::size_t first = 0; first < points.size(); first += sites::ClosestPacket::kSize) {
    closest.count = std::min(sites::ClosestPacket::kSize, points.size() - first);
    for (std::size_t i = 0; i < closest.count; ++i)
      closest.set(i, points[first + i], reference_closest(internals(sites), points[first + i], max_distance));
    sink(first, closest);
  }
}

}  // namespace sdm::reference
