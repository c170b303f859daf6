#include "query/closest/reference.h"

#include <tuple>

#include "geometry/vec.h"
#include "sites/closest_on_face.h"
#include "tree/visit.h"

namespace sdm::closest {
namespace {

// A lower bound on the computed distance of a point of the unit frame to the faces in a box.
double lower_bound(const tree::FloatBox& box, const Vec3& p) {
  return (1 - kSlack) * norm(gap(box, p)) - kSlack;
}

auto order(const ClosestPoint& c) {
  return std::tuple(c.distance, c.type, c.site, c.face);
}

}  // namespace

ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q, double max_distance) {
  const Vec3 unit = sites.frame.to_unit(q);
  ClosestPoint best;
  best.distance = max_distance;
  const auto bound = [&](const tree::FloatBox& box) { return lower_bound(box, unit); };
  // A node is visited even if its bound equals the best distance: the first of equally close sites is
  // returned, and O2 may lie at exactly max_distance.
  const auto enter = [&](double least) { return least <= best.distance * sites.frame.scale; };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const ClosestPoint c = sites::closest_on_face(sites, face, q);
      // The type is none until there is a best one, and follows all others: max_distance itself is near
      // enough.
      if (order(c) < order(best)) best = c;
    }
  };
  tree::visit(sites.tree, tree::NearestFirst{bound, enter, visit_leaf});
  if (best.type == SiteType::none) best.distance = std::numeric_limits<double>::infinity();
  return best;
}

}  // namespace sdm::closest
