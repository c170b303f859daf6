// Bounds on a depth from the thickness of walls.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "bodies/shape/node_ball.h"
#include "inside/inside.h"

namespace sdm::shape {

struct Levels {
  double lower, upper;
};

/// A convex polygon, along the axes of a column.
struct Polygon {
  static constexpr std::size_t kMostCorners = 8;  ///< of a triangle that four planes have cut, and one more

  std::array<Vec3, kMostCorners> corners;
  std::size_t count = 0;

  /// Keeps the points p with x p[1] + y p[2] of at most `most`.
  void clip(double x, double y, double most);
};

/// A prism without ends, of all points above and below a part along a direction u, |u| = 1. The level of a
/// point x is u·(x − origin).
struct WallColumn {
  Vec3 origin{};                           ///< a point of the part
  std::array<Vec3, 3> axes{};              ///< u, and two directions across
  std::array<double, 3> lower{}, upper{};  ///< of the points of the part, along the axes
  /// The half-planes h of the directions across that contain a triangle: h[0] x + h[1] y ≤ h[2].
  std::array<Vec3, 3> sides{};
  std::size_t side_count = 0;
  /// Set for a triangle that is not seen as a line: a point of its plane, at (x, y) across, has the level
  /// slope·(x, y).
  std::optional<Vec2> slope{};

  [[nodiscard]] static WallColumn around(const Corners& triangle, const Vec3& origin, const Vec3& u);
  /// Moves all sides out.
  void enlarge(double by);
  [[nodiscard]] static WallColumn around(const Ball& ball, const Vec3& u);
};

/// Bounds b at the points p of a part inside the solid. A section of the column at a level that no face of
/// the solid passes through is inside or outside as a whole. If it is outside, p leaves the solid on the way
/// straight to that level, so b(p) is at most the difference of the levels: of p and of the next such section
/// above or below. Of a wall across the column that is at most half its thickness, however large the part is.
/// Points at the level of an outside section are outside. The same holds for levels above the plane of a
/// triangle, which bound its depth below a surface that is nearly parallel to it. Infinite if there is no
/// bound near `enough`.
///
/// `winding`: the winding number of the solid at the origin, if known. Those of the sections follow from it
/// by the faces between; otherwise, and where these are not clear, points of the sections are searched for.
[[nodiscard]] double bound_in_column(const sites::SitesData& solid, const inside::InsideTest& inside,
                                     const WallColumn& column, std::optional<int> winding, double enough);

}  // namespace sdm::shape
