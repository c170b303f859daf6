#include "registration/freedoms.h"

#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "registration/point_to_plane.h"

namespace sdm::registration {
namespace {

struct Spectrum {
  Eigen::Matrix<double, 6, 1> determined;  ///< decreasing
  Matrix6 motions;                         ///< as columns
  int free = 0;                            ///< the number of free ones, which come last
};

Spectrum spectrum(const Matrix6& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(information);
  Spectrum result{solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt(),
                  solver.eigenvectors().rowwise().reverse()};
  for (int k = 0; k < 6; ++k) result.free += result.determined[k] < kFree;
  return result;
}

// Rotates a basis of free motions so that as many of them as possible are pure translations: with the
// rotation parts W = U S Vᵀ, those are the columns of V with a singular value of zero. The others are
// orthogonal to them, which makes the screws of a cylinder or a plane rotations about their axes.
Motions separated(const Motions& free) {
  const Eigen::MatrixXd turns = free.topRows<3>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(turns, Eigen::ComputeFullV);
  return free * svd.matrixV().rowwise().reverse();
}

// The axis of the screw with the rotation ω and the translation τ at the centre is where ω × x + τ is along
// ω.
DegreeOfFreedom described(const Motion& motion, const Pivot& pivot) {
  DegreeOfFreedom result;
  result.rotation = vec3(motion.head<3>());
  result.translation = vec3(motion.tail<3>());
  const double squared = squared_norm(result.rotation);
  result.axis_point = pivot.centre;
  if (squared > 1e-12)
    result.axis_point += (pivot.radius / squared) * cross(result.rotation, result.translation);
  return result;
}

}  // namespace

Motions determined_motions(const Correspondences& pairs, const Sites& o2, const Pivot& pivot, double cut) {
  const Spectrum all = spectrum(information(pairs, smooth_normals(pairs, o2), pivot, cut));
  return all.motions.leftCols(6 - all.free);
}

std::array<DegreeOfFreedom, 6> degrees_of_freedom(const Correspondences& pairs, const Sites& o2,
                                                  const Pivot& pivot, double cut, double deviation,
                                                  std::size_t count) {
  const Matrix6 matrix = information(pairs, smooth_normals(pairs, o2), pivot, cut);
  Spectrum all = spectrum(matrix);
  if (all.free > 0) all.motions.rightCols(all.free) = separated(all.motions.rightCols(all.free));
  std::array<DegreeOfFreedom, 6> result;
  for (int k = 0; k < 6; ++k) {
    const Motion motion = all.motions.col(k);
    result[k] = described(motion, pivot);
    result[k].determined = std::sqrt(std::max(0.0, motion.dot(matrix * motion)));
    result[k].free = k >= 6 - all.free;
    result[k].standard_error =
        result[k].free ? std::numeric_limits<double>::infinity()
                       : deviation / (result[k].determined * std::sqrt(static_cast<double>(count)));
  }
  return result;
}

}  // namespace sdm::registration
