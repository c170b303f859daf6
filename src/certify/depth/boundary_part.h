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
