// Parts of the boundary of a solid, which bound the depth of what is near them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "geometry/triangle_pair.h"
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

/// A part of the boundary, and the bounds that it gives at the corners of a triangle.
struct Near {
  BoundaryPart boundary;
  CornerValues distance{};
};

/// The last few that were added.
class NearParts {
 public:
  void add(const Near& near) {
    if (count_ == near_.size()) std::shift_left(near_.begin(), near_.end(), 1), --count_;
    near_[count_++] = near;
  }
  [[nodiscard]] std::span<const Near> all() const { return std::span(near_).first(count_); }

 private:
  std::array<Near, 4> near_{};
  std::size_t count_ = 0;
};

}  // namespace sdm::depth
