/// Affine transforms of meshes and points.
///
/// Threads: a Transform is a plain value.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

#include <array>
#include <span>

namespace sdm {

/// An affine map as a 4×4 matrix M in row-major order, for column vectors: p ↦ M (p, 1). The last row is
/// (0, 0, 0, 1). The identity by default.
struct SDM_API Transform {
  std::array<std::array<double, 4>, 4> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  /// Adds an offset.
  [[nodiscard]] static Transform translation(const Vec3& offset);
  /// Multiplies by a factor, about the origin.
  [[nodiscard]] static Transform scaling(double factor);
  /// Rotates about the X, then the Y, then the Z axis, right-handed. Multiples of 90° are exact.
  [[nodiscard]] static Transform rotation(const Vec3& degrees);
  /// The rotation of a quaternion w + x i + y j + z k, which need not have length 1. Throws sdm::Error if it
  /// is zero or not finite.
  [[nodiscard]] static Transform quaternion(const std::array<double, 4>& wxyz);

  /// Maps a point.
  [[nodiscard]] Vec3 operator()(const Vec3& p) const;
  /// Maps a normal of a surface to that of the mapped surface, of unit length: by the inverse transpose of
  /// the linear part, so that it stays perpendicular to the surface, and on its outside under a reflection
  /// too. 0 if the map is singular, or `n` is 0 or not finite.
  [[nodiscard]] Vec3 normal(const Vec3& n) const;
  /// The map that takes M p back to p: by the cofactors, so that the rotations and translations of poses are
  /// inverted to rounding. Throws sdm::Error if the map is singular or an entry of the inverse is not finite.
  [[nodiscard]] Transform inverse() const;
  /// The determinant of the linear part; negative for a reflection.
  [[nodiscard]] double determinant() const;
  /// The sign of the determinant, without rounding: −1 for a reflection, 0 for a singular map.
  [[nodiscard]] int orientation() const;
  /// (a * b)(p) = a(b(p)) up to rounding.
  friend SDM_API Transform operator*(const Transform& a, const Transform& b);
};

/// Returns the uniform scaling and translation that make the longest side of the bounds 1 and centre them at
/// the origin. Throws sdm::Error unless the bounds have a positive extent. Cost: linear.
[[nodiscard]] SDM_API Transform fit_to_unit(const Mesh& mesh);

/// Maps all positions; a reflection also reverses the faces, so that they keep facing outwards. Throws
/// sdm::Error, and changes nothing, if a coordinate becomes infinite or NaN. Cost: linear.
SDM_API void transform(Mesh& mesh, const Transform& map);
/// The same for points alone.
SDM_API void transform(std::span<Vec3> points, const Transform& map);

}  // namespace sdm
