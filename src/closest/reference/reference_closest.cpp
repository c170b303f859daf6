#include "closest/reference/reference_closest.h"

#include <limits>
#include <tuple>

#include "geometry/vec.h"
#include "sites/closest_on_face.h"
#include "tree/aabb_tree.h"

namespace sdm::reference {
namespace {

class Oracle {
 public:
  Oracle(const sites::SitesData& sites, const Vec3& q, double max_distance)
      : sites_(sites), q_(q), unit_(sites.frame.to_unit(q)) {
    best_.distance = max_distance;  // the type none follows all others: max_distance itself is near enough
  }

  void search(std::uint32_t node) {
    // No face is left out unless its box is farther by this fraction of the distance and of the size of O2:
    // the distances of slivers that are computed from normals are accurate to 1e-7.
    constexpr double kSlack = 1e-6;
    if ((1 - kSlack) * gap(node) - kSlack > best_.distance * sites_.frame.scale) return;
    const tree::AabbTree::Node& here = sites_.tree.nodes[node];
    if (here.leaf()) {
      for (const std::uint32_t face : sites_.tree.items_of(node)) offer(face);
      return;
    }
    const bool right_first = gap(here.right) < gap(node + 1);
    search(right_first ? here.right : node + 1);
    search(right_first ? node + 1 : here.right);
  }

  [[nodiscard]] ClosestPoint result() const {
    ClosestPoint result = best_;
    if (result.type == SiteType::none) result.distance = std::numeric_limits<double>::infinity();
    return result;
  }

 private:
  [[nodiscard]] double gap(std::uint32_t node) const { return norm(tree::gap(sites_.tree.box(node), unit_)); }

  void offer(std::uint32_t face) {
    const auto order = [](const ClosestPoint& c) { return std::tuple(c.distance, c.type, c.site, c.face); };
    const ClosestPoint c = sites::closest_on_face(sites_, face, q_);
    if (order(c) < order(best_)) best_ = c;
  }

  const sites::SitesData& sites_;
  const Vec3& q_;
  Vec3 unit_;
  ClosestPoint best_;
};

}  // namespace

ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q, double max_distance) {
  Oracle oracle(sites, q, max_distance);
  if (!sites.tree.nodes.empty()) oracle.search(0);
  return oracle.result();
}

}  // namespace sdm::reference
