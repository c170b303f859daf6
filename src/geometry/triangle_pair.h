// Distance and intersection of two triangles of any shape, including needles, segments and points.
#pragma once

#include "geometry/triangle.h"

namespace sdm::core {

/// The squared distance of the bounding boxes of two triangles: a lower bound for the triangles.
[[nodiscard]] double squared_box_distance(const Corners& a, const Corners& b);

/// Whether the closed triangles have a point in common; touching counts. Exact for all finite coordinates.
[[nodiscard]] bool triangles_intersect(const Corners& a, const Corners& b);

/// A point of each of two triangles.
struct PointPair {
  double squared;  ///< |point2 − point1|²
  Vec3 point1, point2;
};

/// The closest points of two triangles that do not intersect. They lie on their triangles to rounding, so the
/// distance is never too small. Where two features are parallel to rounding, any of their closest points may
/// be returned. Cost: the distances of all pairs of features.
[[nodiscard]] PointPair closest_points(const Corners& a, const Corners& b);

/// Some corners and sides of a triangle, a bit for each; side k is that from corner k.
struct Features {
  unsigned corners = 0, sides = 0;
};

/// closest_points(a, b), if these features, or the interior of the other triangle, have the only closest
/// points.
[[nodiscard]] PointPair closest_points(const Corners& a, const Features& of_a, const Corners& b,
                                       const Features& of_b);

/// A common point of two triangles that intersect, to rounding.
[[nodiscard]] Vec3 common_point(const Corners& a, const Corners& b);

/// closest_points() or common_point() of any two triangles. `squared` is 0 if and only if they intersect, or
/// are so close that the square underflows.
[[nodiscard]] PointPair closest_or_common(const Corners& a, const Corners& b);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
