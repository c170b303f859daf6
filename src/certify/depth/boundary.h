// The boundary of a solid: its parts, those that a search has found, and the distance b(p) from p to it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/shape/body.h"
#include "search/mixed_bound.h"
#include "sites/sites_data.h"

namespace sdm::depth {

using search::CornerValues;

/// A face that is boundary on one side everywhere, or a point of the boundary. If `clear` > 0, the centre of
/// a ball of that radius outside the solid: ways from it to points inside leave the ball first.
struct BoundaryPart {
  std::uint32_t face = kNone;
  Vec3 point{};
  double clear = 0;
};

/// The distances of the corners of a triangle to parts of the boundary, to rounding: convex in the triangle.
[[nodiscard]] std::array<CornerValues, 2> corner_distances(const sites::SitesData& solid, const Corners& at,
                                                           const std::array<BoundaryPart, 2>& boundary);
[[nodiscard]] inline CornerValues corner_distances(const sites::SitesData& solid, const Corners& at,
                                                   const BoundaryPart& boundary) {
  return corner_distances(solid, at, {boundary, boundary})[0];
}

/// Bounds on b in a triangle by the plane of a face of a convex solid: the heights of the corners below it,
/// which are linear, so that three of them are exact where three faces are equally near. No point of a convex
/// solid is deeper than below the plane of any of its faces. The error of the normal is at most 6e-16 times
/// the square of the longest side over the area, a height errs by as much times the distance from the corner
/// of the face that it is measured from, and mixed_bound() of heights by 1e-15 times that. A multiple of both
/// is added, which is convex in the triangle as well. False of parts that are no face, and of faces whose
/// normal is not good enough.
[[nodiscard]] bool heights_below_plane(const sites::SitesData& solid, const Corners& at,
                                       const BoundaryPart& boundary, CornerValues& heights);

/// A part of the boundary, and the upper bounds on b that it gives at the corners of a triangle.
struct CornerBound {
  BoundaryPart boundary;
  CornerValues distance{};
};

/// The last four bounds that were added.
class RecentBounds {
 public:
  void add(const CornerBound& bound) {
    if (count_ == bounds_.size()) {
      std::shift_left(bounds_.begin(), bounds_.end(), 1);
      --count_;
    }
    bounds_[count_++] = bound;
  }
  [[nodiscard]] std::span<const CornerBound> all() const { return std::span(bounds_).first(count_); }

 private:
  std::array<CornerBound, 4> bounds_{};
  std::size_t count_ = 0;
};

/// The distance b(p) from a point p inside a solid to its boundary.
struct BoundaryDistance {
  double lower = 0, upper = 0;  ///< bounds: those of a solid that intersects itself may differ
  double value = 0;             ///< the distance of `point`, if known
  std::optional<Vec3> point{};  ///< of the boundary
  std::optional<BoundaryPart> nearest{};
};

/// b(p) of a point inside, given its closest point on the surface of the solid.
[[nodiscard]] BoundaryDistance boundary_distance(const shape::Body& solid, const Vec3& p,
                                                 const ClosestPoint& closest);
/// b(p) by the division of the faces that others intersect (SolidBoundary), also for points outside.
[[nodiscard]] BoundaryDistance distance_to_boundary(const shape::Body& solid, const Vec3& p);
/// A face with that closest point which is boundary on one side everywhere, if there is one.
[[nodiscard]] std::optional<BoundaryPart> boundary_face(const shape::Body& solid,
                                                        const ClosestPoint& closest);

/// Bounds b at the points p inside the solid of a triangle with the point c, which is outside, at this
/// distance from the surface. The way in the triangle from c to p passes through some face, at x, so b(p) ≤
/// |p − x|. As c and p are on different sides of its plane, |p − x| is the part of |p − c| that is beyond the
/// plane. A triangle that no face intersects has no point inside. Where c is in the plane or on the face to
/// rounding, p is on the side inside the solid, and x may be c. `triangle` is in the ball about c; stops at
/// `most`.
[[nodiscard]] double bound_beyond_faces(const shape::Body& solid, const Corners& triangle,
                                        const shape::Ball& ball, double distance, double most);

/// Parts of the boundary, each found for a point of a body. They may bound triangles near that point, too.
class KnownBoundary {
 public:
  void clear() { known_.clear(); }
  void add(const Vec3& from, const BoundaryPart& boundary) { known_.push_back({from, boundary}); }
  [[nodiscard]] std::size_t size() const { return known_.size(); }
  /// The recent ones that were found for the two points nearest to `centre`, other than the faces of
  /// `besides`. None if both are among the first `seen`.
  [[nodiscard]] std::optional<std::array<BoundaryPart, 2>> nearest(const Vec3& centre,
                                                                   std::span<const CornerBound> besides,
                                                                   std::size_t seen) const;

 private:
  struct Known {
    Vec3 from;
    BoundaryPart boundary;
  };
  std::vector<Known> known_;
};

}  // namespace sdm::depth
