// The solid angle of a triangle.
#pragma once

#include <sdm/types.h>

#include <cmath>
#include <numbers>

namespace sdm::inside {

/// A solid angle, and how far it may be from the true one.
struct SolidAngle {
  double value = 0, error = 0;
};

/// The signed solid angle of triangle (a, b, c) seen from the origin, in [−2π, 2π], is positive where it runs
/// clockwise as seen from there: over a closed mesh around the origin the angles sum to 4π. Half of it is the
/// argument of a complex number (van Oosterom & Strackee 1983).
struct HalfSolidAngle {
  double real = 0, imaginary = 0;
  double distance = 0;  ///< from 0
  /// Bounds the rounding of the whole angle. Infinite where the origin is so near to the triangle that its
  /// side is not known.
  double error = 0;
};

/// Let u = 2⁻⁵³ and L = |a||b||c|. Coordinates that are differences have relative errors u, so that both
/// parts are computed within 64·u·L. An error of the number turns it by at most π/2 times the error over its
/// distance from 0.
inline HalfSolidAngle half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c), product = la * lb * lc;
  const double imaginary = dot(a, cross(b, c));
  const double real = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const double error = 64 * 0x1p-53 * product;
  const double distance = std::sqrt(imaginary * imaginary + real * real);
  const bool either_side = real <= error && std::abs(imaginary) <= error;
  if (either_side || !(distance > 8 * error)) return {real, imaginary, distance, kInfinity};
  return {real, imaginary, distance, 8 * error / distance};
}

/// The whole angle without the error.
inline double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const HalfSolidAngle half = half_solid_angle(a, b, c);
  return 2 * std::atan2(half.imaginary, half.real);
}

/// A sum of solid angles with one arctangent for all of them: the argument of a product is the sum of the
/// arguments, but for whole turns, which are counted.
class SolidAngleSum {
 public:
  void add(const HalfSolidAngle& half) {
    // A product turns by at most 4·u by its own rounding and that of its factor.
    error_ += half.error + 8 * 0x1p-53;
    if (std::isinf(half.error)) return;
    const double re = half.real / half.distance, im = half.imaginary / half.distance;
    const double real = real_ * re - imaginary_ * im, imaginary = real_ * im + imaginary_ * re;
    // Two arguments of the same sign may exceed ±π together. That of a triangle is never ±π, where its error
    // is infinite, so that two do not make a whole turn.
    if (imaginary_ >= 0 && im >= 0)
      turns_ += imaginary < 0 ? 1 : 0;
    else if (imaginary_ < 0 && im < 0)
      turns_ -= imaginary > 0 || (imaginary == 0 && real < 0) ? 1 : 0;
    real_ = real;
    imaginary_ = imaginary;
  }
  [[nodiscard]] SolidAngle sum() const {
    const double value = 2 * (2 * std::numbers::pi * turns_ + std::atan2(imaginary_, real_));
    return {value, error_ + 4 * 0x1p-53 * std::abs(value)};
  }

 private:
  double real_ = 1, imaginary_ = 0;
  int turns_ = 0;
  double error_ = 0;
};

}  // namespace sdm::inside
