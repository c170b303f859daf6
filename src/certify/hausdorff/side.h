// One side of a solid B: that inside of it, or that outside.
#pragma once

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// A side, for the largest distance of the points of A that are on it. Decided exactly. Thread-safe.
class Side {
 public:
  /// `solid` has an inside, and must outlive this object.
  Side(const sites::SitesData& solid, bool inside) : solid_(solid), inside_(inside) {}

  /// Whether a point that is not on the surface is on this side. Cost: as of inside::contains().
  [[nodiscard]] bool has(const Vec3& p) const;
  /// Whether the triangle has no point in common with the surface, so that all of it is on the same side.
  [[nodiscard]] bool is_one_sided(const Corners& triangle) const;

  /// Whether a plane separates the triangle from all faces of B that are closer than 4 · `slack` to it, both
  /// up to `slack`: it then touches B at most, and none of its points is farther than 2 · `slack` inside or
  /// outside of B if one of them is on the other side. False if there are too many faces to look at.
  [[nodiscard]] bool only_touches(const Corners& triangle, double slack) const;

 private:
  const sites::SitesData& solid_;
  bool inside_;
};

}  // namespace sdm::hausdorff
