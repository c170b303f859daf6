// Two triangles, whatever their shape: needles, segments and points too.
#pragma once

#include <sdm/types.h>

namespace sdm::exact {

using Corners = std::array<Vec3, 3>;

/// The squared distance of the boxes around two triangles: of the triangles at least as much.
[[nodiscard]] double squared_box_distance(const Corners& a, const Corners& b);

/// Whether the closed triangles have a point in common; touching counts. Exact for all finite coordinates.
[[nodiscard]] bool triangles_intersect(const Corners& a, const Corners& b);

/// A point of each of two triangles.
struct PointPair {
  double squared;  ///< |point2 − point1|²
  Vec3 point1, point2;
};

/// The closest two points of triangles that do not intersect. They lie on their triangles to rounding, so
/// that the distance is never too small; where two features are parallel to rounding, any of their closest
/// points. Cost: the distances of all pairs of features.
[[nodiscard]] PointPair closest_points(const Corners& a, const Corners& b);

/// A point on both of two triangles that intersect, to rounding.
[[nodiscard]] Vec3 common_point(const Corners& a, const Corners& b);

/// Either: of any two triangles; 0 apart if and only if they intersect, or so near that squares vanish.
[[nodiscard]] PointPair closest_or_common(const Corners& a, const Corners& b);

}  // namespace sdm::exact
