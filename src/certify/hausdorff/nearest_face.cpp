#include "certify/hausdorff/nearest_face.h"

#include <algorithm>
#include <cmath>

#include "certify/hausdorff/face_distance.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::hausdorff {
namespace {

// Of the faces with allows(face), which lie below nodes with may_allow(node).
template <class MayAllow, class Allows>
NearestFace nearest_allowed(const sites::SitesData& sites, const Vec3& p, std::uint32_t start,
                            const MayAllow& may_allow, const Allows& allows) {
  NearestFace best;
  double lower = std::numeric_limits<double>::infinity();
  best.upper = lower;
  // All points s of a face have |s − p| ≥ u·(s − p), with u the unit vector towards the best point: most
  // faces are excluded by that alone.
  Vec3 towards{};
  const auto beyond = [&](const Corners& face) {
    double least = std::numeric_limits<double>::infinity(), size = 0;
    for (const Vec3& corner : face) {
      const Vec3 r = corner - p;
      least = std::min(least, dot(towards, r));
      size = std::max(size, std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
    }
    return least - kProductRounding * size >= best.upper;
  };
  const auto offer = [&](std::uint32_t face) {
    const Corners corners = corners_of(sites.mesh, face);
    if (beyond(corners)) return;
    const FaceDistance d = face_distance(p, corners);
    lower = std::min(lower, d.lower);
    if (!(d.upper < best.upper)) return;
    best.face = face, best.upper = d.upper, best.point = d.point;
    towards = normalized(best.point - p);
  };
  if (start != kNone) offer(start);
  const Vec3 unit = sites.frame.to_unit(p);
  // Mapping p and the corners of faces into the frame rounds.
  const double rounding = 1e-15 * (1 + std::abs(unit[0]) + std::abs(unit[1]) + std::abs(unit[2]));
  const auto lower_bound = [&](std::uint32_t node, const tree::FloatBox& box) {
    if (!may_allow(node)) return std::numeric_limits<double>::infinity();
    return (1 - 1e-12) * norm(gap(box, unit)) - rounding;
  };
  const auto enter = [&](double bound) { return bound < best.upper * sites.frame.scale; };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf))
      if (face != start && allows(face)) offer(face);
  };
  tree::visit(sites.tree, tree::NearestFirst{lower_bound, enter, visit_leaf});
  best.lower = std::min(lower, best.upper);  // what was excluded is no closer than `upper`
  return best;
}

}  // namespace

NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start) {
  return nearest_allowed(
      sites, p, start, [](std::uint32_t) { return true; }, [](std::uint32_t) { return true; });
}

NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start,
                         const Matching& matching, std::uint32_t face) {
  return nearest_allowed(
      sites, p, start, [&](std::uint32_t node) { return matching.may_allow(face, node); },
      [&](std::uint32_t other) { return matching.allows(face, other); });
}

}  // namespace sdm::hausdorff
