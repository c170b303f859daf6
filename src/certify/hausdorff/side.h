// One side of B, if only the points of A on it count.
#pragma once

#include "geometry/triangle.h"
#include "inside/open_sides.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// A side, for the largest distance of the points of A that are on it. Thread-safe.
class Side {
 public:
  /// Bounds on a triangle that has a point which is not on the side.
  struct Known {
    double upper = 0;      ///< no point of the triangle is farther from B
    double distance = 0;   ///< > 0; the point is at least so far
    double radius = 0;     ///< no point of the triangle is farther from the point
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

/// The points behind an orientable B, or those in front of it, as of SignMethod::side, with all whose side is
/// not certain: whose closest site may be on the boundary of B. The side changes where no distance is 0, as
/// another site becomes the closest one; a triangle is on the other side if it is so for each site that may
/// be the closest one to a point of it.
class SheetSide final : public Side {
 public:
  /// `sheet` must outlive this object. `precision`: points that are closer may be on either side.
  SheetSide(const sites::SitesData& sheet, bool behind, double precision);

  [[nodiscard]] bool has(const Vec3& p, double distance) const override {
    return !is_on_other_side({p, p, p}, distance);
  }
  [[nodiscard]] double bound(const Corners& triangle, const Known& known) const override {
    return is_on_other_side(triangle, known.upper) ? 0 : known.upper;
  }

 private:
  /// The least and the largest product of the corners of a triangle with a direction, from a point.
  struct Extent {
    double least, most;
  };
  [[nodiscard]] static Extent extent(const Corners& triangle, const Vec3& direction, const Vec3& from);

  /// `upper`: no point is farther from B. False if there are too many faces to look at.
  [[nodiscard]] bool is_on_other_side(const Corners& triangle, double upper) const;
  /// Whether all points whose closest point is of this face, its edges and corners included, are on the other
  /// side.
  [[nodiscard]] bool by_face(const Corners& triangle, std::uint32_t face) const;
  [[nodiscard]] bool by_edge(const Corners& triangle, std::uint32_t edge) const;
  [[nodiscard]] bool by_vertex(const Corners& triangle, std::uint32_t vertex) const;
  /// Whether the triangle is on the other side of the plane through a point of a site, up to the margin if
  /// `touching`.
  [[nodiscard]] bool is_beyond(const Corners& triangle, const Vec3& normal, const Vec3& at,
                               bool touching) const;
  /// The unit vector in the plane of a face that is normal to its k-th side and points into the face.
  [[nodiscard]] Vec3 inward(std::uint32_t face, int k) const;

  const sites::SitesData& sheet_;
  const inside::BoundarySites& boundary_;
  double towards_;  ///< 1 if the points in front count, −1 if those behind
  double margin_;   ///< of what is certain
};

}  // namespace sdm::hausdorff
