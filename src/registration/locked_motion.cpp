#include "registration/locked_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sdm::registration {
namespace {

// By which rotation vector exp(ω) turns further per change of a component of ω: the left Jacobian
// sin θ / θ I + (1 − sin θ / θ) a aᵀ + (1 − cos θ) / θ [a]×, ω = θ a (Barfoot, State Estimation for
// Robotics, equation 7.77).
Eigen::Matrix3d left_jacobian(const Vec3& turn) {
  const double angle = norm(turn);
  constexpr double kSmall = 1e-8;  // below it, the terms in θ are less than rounding
  if (angle < kSmall) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d a = vector((1 / angle) * turn);
  const double sine = std::sin(angle) / angle, cosine = (1 - std::cos(angle)) / angle;
  Eigen::Matrix3d cross;
  cross << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return sine * Eigen::Matrix3d::Identity() + (1 - sine) * a * a.transpose() + cosine * cross;
}

// The eigenvalues λ and eigenvectors of BᵀB for columns B: B V / √λ is orthonormal.
struct Gram {
  Motion roots = Motion::Ones();  ///< √λ of the columns, 1 of the others
  Matrix6 vectors = Matrix6::Identity();
};

Gram gram(const Motions& columns) {
  // The rest of the matrix has a larger eigenvalue, and comes last.
  const double sum = columns.squaredNorm();
  const Spectrum<6> found = spectrum(reduced(Matrix6::Identity(), columns, 1 + 2 * sum));
  Gram result;
  for (int k = 0; k < columns.cols(); ++k)
    result.roots[k] = std::sqrt(std::max(found.values[k], 1e-15 * sum));
  result.vectors = found.vectors;
  return result;
}

}  // namespace

LockedMotion::LockedMotion(const AlignFreedoms& freedoms, const Affine& start)
    : freedoms_(freedoms), start_(start) {}

Motions LockedMotion::tangents(const Pivot& pivot) const {
  const auto free =
      std::ranges::count(freedoms_.rotations, true) + std::ranges::count(freedoms_.translations, true);
  Motions result(6, free);
  const Eigen::Matrix3d jacobian = left_jacobian(turn_);
  const Vec3 arm = pivot.centre - freedoms_.about - shift_;
  int column = 0;
  for (int k = 0; k < 3; ++k)
    if (freedoms_.rotations[k]) {
      const Eigen::Vector3d turn = jacobian.col(k);
      result.col(column++) << pivot.radius * turn, vector(cross(vec3(turn), arm));
    }
  for (int k = 0; k < 3; ++k)
    if (freedoms_.translations[k]) result.col(column++) << Eigen::Vector3d::Zero(), Eigen::Vector3d::Unit(k);
  return result;
}

Motions LockedMotion::allowed(const Pivot& pivot) const {
  const Motions columns = tangents(pivot);
  const auto count = columns.cols();
  const Gram found = gram(columns);
  return columns *
         (found.vectors.topLeftCorner(count, count) * found.roots.head(count).cwiseInverse().asDiagonal());
}

void LockedMotion::move(const Motion& motion, const Pivot& pivot) {
  // As B V / √λ is orthonormal, the coefficients of a motion in the span of B are V / √λ (B V / √λ)ᵀ motion.
  const Motions columns = tangents(pivot);
  const auto count = columns.cols();
  const Gram found = gram(columns);
  const Matrix6 scaled = found.vectors * found.roots.cwiseInverse().asDiagonal();
  const Motions orthonormal = columns * scaled.topLeftCorner(count, count);
  Motion change = Motion::Zero();
  change.head(count) = scaled.topLeftCorner(count, count) * (orthonormal.transpose() * motion);
  int column = 0;
  for (int k = 0; k < 3; ++k)
    if (freedoms_.rotations[k]) turn_[k] += change[column++];
  for (int k = 0; k < 3; ++k)
    if (freedoms_.translations[k]) shift_[k] += change[column++];
}

Affine LockedMotion::pose() const {
  if (turn_ == Vec3{}) return {start_.rows, start_.offset + shift_};
  const double angle = norm(turn_);
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, vector((1 / angle) * turn_)).toRotationMatrix();
  Eigen::Matrix3d before;
  for (int i = 0; i < 3; ++i) before.row(i) = vector(start_.rows[i]).transpose();
  const Eigen::Matrix3d after = rotation * before;
  Affine result;
  for (int i = 0; i < 3; ++i) result.rows[i] = vec3(after.row(i).transpose());
  result.offset = freedoms_.about + vec3(rotation * vector(start_.offset - freedoms_.about)) + shift_;
  return result;
}

}  // namespace sdm::registration
