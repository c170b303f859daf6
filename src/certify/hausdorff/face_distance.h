// Bounds on the distance of a point and a triangle that hold in spite of rounding.
#pragma once

#include <sdm/types.h>

#include "geometry/triangle_pair.h"

namespace sdm::hausdorff {

/// lower ≤ distance ≤ upper; a few units in the last place of the distance and the size of the triangle
/// apart, unless this is almost a segment, or its border is closer than 1e-8 of its size.
struct FaceDistance {
  double lower = 0, upper = 0;
  Vec3 point{};  ///< of the triangle, to rounding, at most `upper` from the query
};

/// Bounds on the distance from p to a triangle of any shape, also a segment or a point.
[[nodiscard]] FaceDistance face_distance(const Vec3& p, const Corners& face);

/// The upper bound only: 0 if p is a corner.
[[nodiscard]] double upper_face_distance(const Vec3& p, const Corners& face);

}  // namespace sdm::hausdorff
