// One side of an open B.
#pragma once

#include "certify/hausdorff/side.h"
#include "inside/shape_signs.h"

namespace sdm::hausdorff {

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
  /// From the k-th side of a face into it, of length 1.
  [[nodiscard]] Vec3 inward(std::uint32_t face, int k) const;

  const sites::SitesData& sheet_;
  const inside::BoundarySites& boundary_;
  double towards_;  ///< 1 if the points in front count, −1 if those behind
  double margin_;   ///< of what is certain
};

}  // namespace sdm::hausdorff
