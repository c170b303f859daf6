// One side of B, if only the points of A on it count.
#pragma once

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// A side, for the largest distance of the points of A that are on it. Thread-safe.
class Side {
 public:
  /// What is known of a triangle with a point that is not on the side.
  struct Known {
    double upper = 0;      ///< no point of the triangle is farther from B
    double distance = 0;   ///< > 0; the point is at least so far
    double reach = 0;      ///< of the triangle, from the point
    double precision = 0;  ///< distances that are less do not matter
  };

  virtual ~Side() = default;

  /// Whether a point that is not on the surface, and at most `distance` from it, counts: it is on this side,
  /// or that is not certain.
  [[nodiscard]] virtual bool has(const Vec3& p, double distance) const = 0;
  /// Returns an upper bound on the distance of the points of a triangle that count.
  [[nodiscard]] virtual double bound(const Corners& triangle, const Known& known) const = 0;
};

/// The inside of a solid, or the outside. Decided exactly.
class SolidSide final : public Side {
 public:
  /// `solid` has an inside, and must outlive this object.
  SolidSide(const sites::SitesData& solid, bool inside) : solid_(solid), inside_(inside) {}

  /// Whether a point that is not on the surface is on this side. Cost: as of inside::contains().
  [[nodiscard]] bool has(const Vec3& p) const;
  [[nodiscard]] bool has(const Vec3& p, double) const override { return has(p); }
  [[nodiscard]] double bound(const Corners& triangle, const Known& known) const override;

 private:
  /// Whether the triangle has no point in common with the surface, so that all of it is on the same side.
  [[nodiscard]] bool is_one_sided(const Corners& triangle) const;
  /// Whether a plane separates the triangle from all faces of B that are closer than 4 · `slack` to it, both
  /// up to `slack`: it then touches B at most, and none of its points is farther than 2 · `slack` inside or
  /// outside of B if one of them is on the other side. False if there are too many faces to look at.
  [[nodiscard]] bool only_touches(const Corners& triangle, double slack) const;

  const sites::SitesData& solid_;
  bool inside_;
};

}  // namespace sdm::hausdorff
