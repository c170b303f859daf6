// The solid angle of a triangle.
#pragma once

#include <sdm/types.h>

#include <cmath>
#include <limits>

#include "geometry/vec.h"

namespace sdm::inside {

/// A solid angle, and how far it may be from the true one.
struct SolidAngle {
  double value = 0, error = 0;
};

/// The signed solid angle of triangle (a, b, c) seen from the origin, in [−2π, 2π], positive where it runs
/// clockwise as seen from there: over a closed mesh around the origin the angles sum to 4π (van Oosterom &
/// Strackee 1983). The error bounds the rounding: it is infinite where the origin is so near to the triangle
/// that its side is not known.
///
/// With u = 2⁻⁵³ and L = |a||b||c|, coordinates that are differences have relative errors u, so that the
/// numerator and the denominator are computed within 64·u·L. Half of the angle is that of the point
/// (denominator, numerator): an error of the point turns it by at most π/2 times the error over the distance
/// from 0.
inline SolidAngle bounded_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c), product = la * lb * lc;
  const double numerator = dot(a, cross(b, c));
  const double denominator = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const double error = 64 * 0x1p-53 * product;
  const double distance = std::sqrt(numerator * numerator + denominator * denominator);
  const double value = 2 * std::atan2(numerator, denominator);
  const bool either_side = denominator <= error && std::abs(numerator) <= error;
  if (either_side || !(distance > 8 * error)) return {value, std::numeric_limits<double>::infinity()};
  return {value, 8 * error / distance};
}

/// The same without the error.
inline double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return bounded_solid_angle(a, b, c).value;
}

}  // namespace sdm::inside
