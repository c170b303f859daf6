// Rotations in three dimensions.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cmath>

namespace sdm::scenes {

/// The columns of a 3 × 3 matrix.
using Matrix = std::array<Vec3, 3>;

inline Vec3 operator*(const Matrix& m, const Vec3& x) {
  return x[0] * m[0] + x[1] * m[1] + x[2] * m[2];
}
inline Matrix operator*(const Matrix& a, const Matrix& b) {
  return {a * b[0], a * b[1], a * b[2]};
}

/// The rotation by `angle` (radians, right-handed) about an axis of length 1: Rodrigues' formula.
inline Matrix rotation_about(const Vec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix m;
  for (int k = 0; k < 3; ++k) {
    Vec3 e{};
    e[k] = 1;
    m[k] = c * e + s * cross(axis, e) + ((1 - c) * axis[k]) * axis;
  }
  return m;
}

/// The rotation R of the polar decomposition A = RS, by iteration from `rotation`. Makes only a few
/// iterations: if `rotation` is far from R, the result may be too. It is always a rotation, even if A is
/// singular or a reflection. M. Müller, J. Bender, N. Chentanez and M. Macklin, "A Robust Method to Extract
/// the Rotational Part of Deformations" (2016), with matrices in place of quaternions.
inline Matrix rotation_part(const Matrix& a, Matrix rotation) {
  constexpr int kMaxIterations = 20;
  constexpr double kEnough = 1e-9;
  for (int i = 0; i < kMaxIterations; ++i) {
    Vec3 torque{};
    double trace = 0;
    for (int k = 0; k < 3; ++k) {
      torque += cross(rotation[k], a[k]);
      trace += dot(rotation[k], a[k]);
    }
    const Vec3 turn = (1 / (std::abs(trace) + kEnough)) * torque;
    const double angle = norm(turn);
    if (angle < kEnough) break;
    rotation = rotation_about((1 / angle) * turn, angle) * rotation;
  }
  // Products of rotations drift, so the columns are orthonormalised.
  rotation[0] = normalized(rotation[0]);
  rotation[1] = normalized(rotation[1] - dot(rotation[0], rotation[1]) * rotation[0]);
  rotation[2] = cross(rotation[0], rotation[1]);
  return rotation;
}

}  // namespace sdm::scenes
