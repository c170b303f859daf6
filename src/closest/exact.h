// The closest point in double precision, of all faces or of some: for few points, where single precision does
// not tell faces apart.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>

#include "sites/closest_on_face.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::closest {

/// No face is excluded unless its box is farther than the best distance by this fraction of the distance and
/// of the size of O2. The distances of slivers that are computed from normals are accurate to 1e-7.
constexpr double kSlack = 1e-6;

/// A lower bound on the computed distance of a point of the unit frame to the faces in a box.
[[nodiscard]] inline double lower_bound(const tree::FloatBox& box, const Vec3& p) {
  return (1 - kSlack) * norm(gap(box, p)) - kSlack;
}

/// The first of faces by (distance, type, site, face): the result does not depend on the order of offers.
class FirstClosest {
 public:
  FirstClosest(const sites::SitesData& sites, const Vec3& q, double max_distance) : sites_(sites), q_(q) {
    best_.distance = max_distance;
  }
  void offer(std::uint32_t face) {
    const auto order = [](const ClosestPoint& c) { return std::tuple(c.distance, c.type, c.site, c.face); };
    const ClosestPoint c = sites::closest_on_face(sites_, face, q_);
    // The type is none until there is a best one, and follows all others: max_distance itself is near
    // enough.
    if (order(c) < order(best_)) best_ = c;
  }
  [[nodiscard]] double distance() const { return best_.distance; }
  [[nodiscard]] ClosestPoint result() const {
    ClosestPoint result = best_;
    if (result.type == SiteType::none) result.distance = kInfinity;
    return result;
  }

 private:
  const sites::SitesData& sites_;
  const Vec3& q_;
  ClosestPoint best_;
};

/// Scalar, double precision, nearest child first over the binary tree; all results are accurate to rounding.
/// The first of all faces by (distance, type, site, face): the result depends on the faces only, not on the
/// tree. Of the faces with allows(face), which lie below nodes with may_allow(node).
template <class MayAllow, class Allows>
[[nodiscard]] ClosestPoint exact_closest(const sites::SitesData& sites, const Vec3& q, double max_distance,
                                         const MayAllow& may_allow, const Allows& allows) {
  constexpr double kNever = kInfinity;
  const Vec3 unit = sites.frame.to_unit(q);
  FirstClosest best(sites, q, max_distance);
  const auto bound = [&](std::uint32_t node, const tree::FloatBox& box) {
    return may_allow(node) ? lower_bound(box, unit) : kNever;
  };
  // A node is visited even if its bound equals the best distance: the first of equally close sites is
  // returned, and O2 may lie at exactly max_distance.
  const auto enter = [&](double least) {
    return least < kNever && least <= best.distance() * sites.frame.scale;
  };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf))
      if (allows(face)) best.offer(face);
  };
  tree::visit(sites.tree, tree::NearestFirst{bound, enter, visit_leaf});
  return best.result();
}

/// The same of listed faces. Cost: linear in them.
[[nodiscard]] inline ClosestPoint exact_closest(const sites::SitesData& sites, const Vec3& q,
                                                double max_distance, std::span<const std::uint32_t> faces) {
  FirstClosest best(sites, q, max_distance);
  for (const std::uint32_t face : faces) best.offer(face);
  return best.result();
}

/// The same of all faces.
[[nodiscard]] ClosestPoint exact_closest(const sites::SitesData& sites, const Vec3& point,
                                         double max_distance);

}  // namespace sdm::closest
