#include "registration/freedoms.h"

#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "registration/point_to_plane.h"

namespace sdm::registration {
namespace {

struct OrderedMotions {
  Motion determined;  ///< decreasing
  Matrix6 motions;    ///< as columns
  int free = 0;       ///< the number of free ones, which come last
};

OrderedMotions ordered_motions(const Matrix6& information) {
  const Spectrum<6> all = spectrum(information);
  OrderedMotions result{all.values.reverse().cwiseMax(0).cwiseSqrt(), all.vectors.rowwise().reverse()};
  for (int k = 0; k < 6; ++k) result.free += result.determined[k] < kFree;
  return result;
}

// Rotates a basis of free motions so that as many of them as possible are pure translations: with the
// rotation parts W, those are the eigenvectors of WᵀW with an eigenvalue of zero. The others are orthogonal
// to them, which makes the screws of a cylinder or a plane rotations about their axes. W is a part of
// orthonormal columns, so that its eigenvalues are at most 1: the rest of the matrix comes last.
Motions separated(const Motions& free) {
  Matrix6 turns = Matrix6::Zero();
  turns.topLeftCorner<3, 3>().setIdentity();
  return free * spectrum(reduced(turns, free, 2)).vectors.topLeftCorner(free.cols(), free.cols());
}

// The axis of the screw with the rotation ω and the translation τ at the centre is where ω × x + τ is along
// ω.
DegreeOfFreedom described(const Motion& motion, const Pivot& pivot) {
  DegreeOfFreedom result;
  result.rotation = vec3(motion.head<3>());
  result.translation = vec3(motion.tail<3>());
  const double squared = squared_norm(result.rotation);
  if (squared > 1e-12)
    result.axis_point = pivot.centre + (pivot.radius / squared) * cross(result.rotation, result.translation);
  return result;
}

}  // namespace

Motions determined_motions(const Correspondences& pairs, const Sites& o2, const Pivot& pivot, double cut) {
  const OrderedMotions all = ordered_motions(information(pairs, smooth_normals(pairs, o2), pivot, cut));
  return all.motions.leftCols(6 - all.free);
}

std::array<DegreeOfFreedom, 6> degrees_of_freedom(const Correspondences& pairs, const Sites& o2,
                                                  const Pivot& pivot, double cut, double deviation,
                                                  std::size_t count) {
  const Matrix6 matrix = information(pairs, smooth_normals(pairs, o2), pivot, cut);
  OrderedMotions all = ordered_motions(matrix);
  if (all.free > 0) all.motions.rightCols(all.free) = separated(all.motions.rightCols(all.free));
  std::array<DegreeOfFreedom, 6> result;
  for (int k = 0; k < 6; ++k) {
    const Motion motion = all.motions.col(k);
    result[k] = described(motion, pivot);
    result[k].determined = std::sqrt(std::max(0.0, motion.dot(matrix * motion)));
    result[k].free = k >= 6 - all.free;
    if (!result[k].free)
      result[k].standard_error = deviation / (result[k].determined * std::sqrt(static_cast<double>(count)));
  }
  return result;
}

}  // namespace sdm::registration
