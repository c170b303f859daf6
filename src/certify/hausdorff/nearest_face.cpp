#include "certify/hausdorff/nearest_face.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geometry/rounding.h"
#include "tree/visit.h"

namespace sdm::hausdorff {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

double largest_coordinate(const Vec3& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

// A point y of a triangle that is closest to p up to rounding. The kernels of geometry/point_triangle.h give
// the closest point; this gives one that surely lies on the triangle, seen from p, and how far rounding may
// have moved it, so that the bounds hold. Its regions are tested as there.
struct Nearest {
  Corners r;        // corners − p
  Vec3 to;          // y − p
  double squared;   // |to|²
  double rounding;  // of |to|

  Nearest(const Vec3& p, const Corners& face) : r{face[0] - p, face[1] - p, face[2] - p} {
    const Vec3 side[3] = {face[1] - face[0], face[2] - face[1], face[0] - face[2]};
    // Corners are compared with each other and with the feet on edges and in the interior. Each of these is
    // given by weights ≥ 0 of corners, so it lies on the triangle, even where rounding makes it a poor
    // choice.
    squared = kInfinity;
    for (int k = 0; k < 3; ++k)
      if (const double s = squared_norm(r[k]); s < squared) {
        to = r[k];
        squared = s;
      }
    rounding = 0;
    const auto offer = [&](const Vec3& y) {
      if (const double s = squared_norm(y); s < squared) {
        to = y;
        squared = s;
        rounding = 8 * kEpsilon *
                   std::max({largest_coordinate(r[0]), largest_coordinate(r[1]), largest_coordinate(r[2])});
      }
    };
    const Vec3 normal = cross(side[0], side[1]), turned = cross(normal, r[0]);
    const double square = squared_norm(normal), v = dot(turned, side[2]), w = dot(turned, side[0]);
    if (v > 0 && w > 0 && v + w < square) {
      const double length = std::max({squared_norm(side[0]), squared_norm(side[1]), squared_norm(side[2])});
      constexpr double kThick = 1e-6;  // height² / length²
      const bool thick = square > kThick * length * length;
      if (over_inside(side, normal, v / square, w / square, thick ? 0 : 2, offer) && thick) return;
    }
    for (int k = 0; k < 3; ++k) {
      const int next = k < 2 ? k + 1 : 0;
      const double along = -dot(r[k], side[k]), length = squared_norm(side[k]);
      if (along > 0 && along < length) offer((1 - along / length) * r[k] + along / length * r[next]);
    }
  }

  // Offers the foot in the interior with these weights of the second and third corner. The weights of a thin
  // triangle are inaccurate: each step adds those of the rest, from the foot to p. Returns whether the foot
  // is in the triangle.
  template <class Offer>
  bool over_inside(const Vec3 (&side)[3], const Vec3& normal, double v, double w, int steps,
                   const Offer& offer) const {
    const auto foot = [&] { return (1 - v - w) * r[0] + v * r[1] + w * r[2]; };
    const double inverse = 1 / squared_norm(normal);
    for (; steps > 0; --steps) {
      const Vec3 turned = cross(normal, foot());
      v += inverse * dot(turned, side[2]);
      w += inverse * dot(turned, side[0]);
    }
    if (!(v >= 0 && w >= 0 && v + w <= 1)) return false;
    offer(foot());
    return true;
  }

  [[nodiscard]] double upper() const { return (1 + 4 * kEpsilon) * std::sqrt(squared) + rounding; }
};

}  // namespace

double upper_face_distance(const Vec3& p, const Corners& face) {
  return Nearest(p, face).upper();
}

// The lower bound: for any unit vector u and any point s of the triangle, |s − p| ≥ u·(s − p), whose minimum
// is attained at a corner. It is the distance itself for the direction from p to the closest point. Where
// that is rounded, as p is very near, the normal of the triangle does better.
FaceDistance face_distance(const Vec3& p, const Corners& face) {
  const Nearest nearest(p, face);
  FaceDistance result{.lower = 0, .upper = nearest.upper(), .point = p + nearest.to};
  const Vec3 normal = normalized(cross(face[1] - face[0], face[2] - face[1]));
  const double side = dot(normal, nearest.to) < 0 ? -1 : 1;
  for (const Vec3& u : {normalized(nearest.to), side * normal}) {
    double least = kInfinity;
    for (const Vec3& r : nearest.r) least = std::min(least, dot(u, r) - 8 * kEpsilon * norm(r));
    result.lower = std::max(result.lower, least);
  }
  return result;
}

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
    best_.face = face;
    best_.upper = d.upper;
    best_.point = d.point;
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
      if (!may_allow(node)) return kInfinity;
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
    double least = kInfinity, size = 0;
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
  double lower_ = kInfinity;
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
