#include "certify/hausdorff/nearest_face.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "certify/hausdorff/face_distance.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::hausdorff {
namespace {

// The nearest of the faces that are offered.
class NearestSearch {
 public:
  NearestSearch(const sites::SitesData& sites, const Vec3& p) : sites_(sites), p_(p) { best_.upper = lower_; }

  void offer(std::uint32_t face) {
    const Corners corners = corners_of(sites_.mesh, face);
    if (is_beyond(corners)) return;
    const FaceDistance d = face_distance(p_, corners);
    lower_ = std::min(lower_, d.lower);
    if (!(d.upper < best_.upper)) return;
    best_.face = face, best_.upper = d.upper, best_.point = d.point;
    towards_ = normalized(best_.point - p_);
  }

  // Offers the faces with allows(face), which lie below nodes with may_allow(node), but for those that are
  // farther than the nearest one, and for `start`.
  template <class MayAllow, class Allows>
  void search_tree(std::uint32_t start, const MayAllow& may_allow, const Allows& allows) {
    const Vec3 unit = sites_.frame.to_unit(p_);
    // Mapping p and the corners of faces into the frame rounds.
    const double rounding = 1e-15 * (1 + std::abs(unit[0]) + std::abs(unit[1]) + std::abs(unit[2]));
    const auto lower_bound = [&](std::uint32_t node, const tree::FloatBox& box) {
      if (!may_allow(node)) return std::numeric_limits<double>::infinity();
      return (1 - 1e-12) * norm(gap(box, unit)) - rounding;
    };
    const auto enter = [&](double bound) { return bound < best_.upper * sites_.frame.scale; };
    const auto visit_leaf = [&](std::uint32_t leaf) {
      for (const std::uint32_t face : sites_.tree.items_of(leaf))
        if (face != start && allows(face)) offer(face);
    };
    tree::visit(sites_.tree, tree::NearestFirst{lower_bound, enter, visit_leaf});
  }

  [[nodiscard]] NearestFace result() const {
    NearestFace result = best_;
    result.lower = std::min(lower_, best_.upper);  // what was excluded is no closer than `upper`
    return result;
  }

 private:
  // All points s of a face have |s − p| ≥ u·(s − p), with u the unit vector towards the best point: most
  // faces are excluded by that alone.
  [[nodiscard]] bool is_beyond(const Corners& face) const {
    double least = std::numeric_limits<double>::infinity(), size = 0;
    for (const Vec3& corner : face) {
      const Vec3 r = corner - p_;
      least = std::min(least, dot(towards_, r));
      size = std::max(size, std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
    }
    return least - kProductRounding * size >= best_.upper;
  }

  const sites::SitesData& sites_;
  const Vec3& p_;
  NearestFace best_;
  double lower_ = std::numeric_limits<double>::infinity();
  Vec3 towards_{};
};

}  // namespace

NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start) {
  const auto all = [](std::uint32_t) { return true; };
  NearestSearch nearest(sites, p);
  if (start != kNone) nearest.offer(start);
  nearest.search_tree(start, all, all);
  return nearest.result();
}

NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start,
                         const Matching& matching, std::uint32_t face) {
  constexpr std::size_t kMany = facing::FacingSearch::kManyNodes;
  std::size_t nodes = 0;
  const auto allows = [&](std::uint32_t other) { return matching.allows(face, other); };
  NearestSearch nearest(sites, p);
  if (start != kNone) nearest.offer(start);
  nearest.search_tree(
      start, [&](std::uint32_t node) { return ++nodes <= kMany && matching.may_allow(face, node); }, allows);
  if (nodes <= kMany) return nearest.result();
  if (const auto few = matching.few_allowed(face))
    for (const std::uint32_t other : *few) nearest.offer(other);
  else
    nearest.search_tree(
        start, [&](std::uint32_t node) { return matching.may_allow(face, node); }, allows);
  return nearest.result();
}

}  // namespace sdm::hausdorff
