// Eigen, limited to its parts under the MPL.
#pragma once

#define EIGEN_MPL2_ONLY
#include <Eigen/Core>
#include <Eigen/LU>

#include <sdm/types.h>

namespace sdm::registration {

/// A small rigid motion about a centre: the rotation vector times the radius of gyration, then the
/// translation, both as lengths.
using Motion = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Directions of motion as columns.
using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

/// The matrix of a quadratic form of motions, for those in the span of the columns, with `rest` on the
/// remaining diagonal: of fixed size, since Eigen's methods for any size take half a minute to compile.
inline Matrix6 reduced(const Matrix6& form, const Motions& motions, double rest) {
  Matrix6 result = rest * Matrix6::Identity();
  result.topLeftCorner(motions.cols(), motions.cols()) = motions.transpose() * form * motions;
  return result;
}

/// Eigenvalues of a symmetric matrix, increasing, and its orthonormal eigenvectors as columns.
template <int size>
struct Spectrum {
  Eigen::Matrix<double, size, 1> values;
  Eigen::Matrix<double, size, size> vectors;
  bool found = false;  ///< false if the matrix is not finite
};
[[nodiscard]] Spectrum<3> spectrum(const Eigen::Matrix3d& matrix);
[[nodiscard]] Spectrum<6> spectrum(const Matrix6& matrix);

inline Eigen::Vector3d vector(const Vec3& v) {
  return {v[0], v[1], v[2]};
}
inline Vec3 vec3(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

/// Where motions turn, and the length that a rotation of one radian counts as.
struct Pivot {
  Vec3 centre{};
  double radius = 1;
};

}  // namespace sdm::registration
