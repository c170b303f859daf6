// The balls that touch a plane at a point, and the smallest of them that reaches a triangle.
#pragma once

#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm::thickness {

/// The ball of radius r about p + r n touches the plane through p with the unit normal n at p, and reaches
/// the point q at
///   r(q) = |q − p|² / (2 n·(q − p)),
/// if q is above the plane; otherwise no ball does. A larger ball contains a smaller one.
struct Touching {
  Vec3 p{}, n{};
};

struct TouchedPoint {
  double radius = kInfinity;
  Vec3 point{};
};

/// The least radius at which the ball reaches the closed triangle, and where: the infimum over its points
/// above the plane. 0 for a triangle that contains p and points above the plane. Exact to double rounding.
/// Cost: O(1).
[[nodiscard]] TouchedPoint smallest_ball(const Touching& ball, const Corners& corners);

}  // namespace sdm::thickness
