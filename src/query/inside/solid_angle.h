// The solid angle of a triangle.
#pragma once

#include <sdm/types.h>

#include <cmath>

#include "geometry/vec.h"

namespace sdm::inside {

/// The signed solid angle of triangle (a, b, c) seen from the origin, in (−2π, 2π], positive where it runs
/// clockwise as seen from there: over a closed mesh around the origin the angles sum to 4π (van Oosterom &
/// Strackee 1983).
inline double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double numerator = dot(a, cross(b, c));
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(numerator, denominator);
}

}  // namespace sdm::inside
