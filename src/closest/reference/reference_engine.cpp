#include "closest/reference/reference_engine.h"

#include <algorithm>
#include <tuple>

#include "sites/closest_on_face.h"
#include "tree/visit.h"

namespace sdm::reference {

ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q, double max_distance) {
  // No face is left out unless its box is farther by this fraction of the distance and of the size of O2: the
  // distances of slivers that are computed from normals are accurate to 1e-7.
  constexpr double kSlack = 1e-6;
  const Vec3 unit = sites.frame.to_unit(q);
  ClosestPoint best;  // of type none, which follows all others: max_distance itself is near enough
  best.distance = max_distance;
  const auto bound = [&](const tree::FloatBox& box) {
    return (1 - kSlack) * norm(tree::gap(box, unit)) - kSlack;
  };
  const auto enter = [&](double least) { return !(least > best.distance * sites.frame.scale); };
  const auto order = [](const ClosestPoint& c) { return std::tuple(c.distance, c.type, c.site, c.face); };
  const auto offer = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const ClosestPoint c = sites::closest_on_face(sites, face, q);
      if (order(c) < order(best)) best = c;
    }
  };
  tree::visit(sites.tree, tree::NearestFirst{bound, enter, offer});
  if (best.type == SiteType::none) best.distance = kInfinity;
  return best;
}

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
