// Eigen, limited to its parts under the MPL.
#pragma once

#define EIGEN_MPL2_ONLY
#include <Eigen/Dense>

#include <sdm/types.h>

#include "geometry/affine.h"

namespace sdm::registration {

/// A small rigid motion about a centre: the rotation vector times the radius of gyration, then the
/// translation, both as lengths.
using Motion = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Directions of motion as columns.
using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

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
