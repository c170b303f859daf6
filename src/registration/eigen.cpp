#include "registration/eigen.h"

#include <Eigen/Eigenvalues>

namespace sdm::registration {
namespace {

template <int size>
Spectrum<size> solved(const Eigen::Matrix<double, size, size>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, size, size>> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

}  // namespace

Spectrum<3> spectrum(const Eigen::Matrix3d& matrix) {
  return solved(matrix);
}

Spectrum<6> spectrum(const Matrix6& matrix) {
  return solved(matrix);
}

}  // namespace sdm::registration
