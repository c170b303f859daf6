#include "registration/point_to_plane.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace sdm::registration {
bool has_weight(const Correspondences& pairs, std::size_t i, double cut) {
  return pairs.usable[i] && pairs.distances[i] <= cut;
}

Motion normal_motion(const Vec3& point, const Vec3& normal, const Pivot& pivot) {
  Motion j;
  j << vector((1 / pivot.radius) * cross(point - pivot.centre, normal)), vector(normal);
  return j;
}

// Sums are in the order of the samples, so that they do not depend on the number of threads.
Matrix6 information(const Correspondences& pairs, std::span<const Vec3> normals, const Pivot& pivot,
                    double cut) {
  Matrix6 sum = Matrix6::Zero();
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (!has_weight(pairs, i, cut)) continue;
    const Motion j = normal_motion(pairs.points[i], normals[i], pivot);
    sum.noalias() += j * j.transpose();
    ++count;
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

double trimming_cut(const Correspondences& pairs, const Pivot& pivot, const Motions& motions) {
  // The median magnitude of a normal distribution is 0.6745 standard deviations.
  constexpr double kCut = 3 * 1.4826, kLeastCut = 1e-9, kLeast = 0.25;
  std::vector<double> distances;
  for (std::size_t i = 0; i < pairs.points.size(); ++i)
    if (pairs.usable[i]) distances.push_back(pairs.distances[i]);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  double cut = std::max(kCut * *middle, kLeastCut * pivot.radius);
  const double largest = *std::ranges::max_element(middle, distances.end());
  if (cut >= largest || motions.cols() == 0) return cut;

  const auto kept_information = [&](double within) -> Matrix6 {
    const auto kept =
        static_cast<double>(std::ranges::count_if(distances, [&](double d) { return d <= within; }));
    return kept * information(pairs, pairs.normals, pivot, within);
  };
  // A share of the information on every motion, m·Am ≥ share m·Bm: A − share B has no negative eigenvalue.
  const Matrix6 least = kLeast * kept_information(largest);
  for (; cut < largest; cut *= 2) {
    const Matrix6 more = reduced(kept_information(cut) - least, motions, least.trace());
    if (spectrum(more).values[0] >= 0) break;
  }
  return cut;
}

Motion solved_within(const Matrix6& matrix, const Motions& motions, const Motion& right) {
  Motion along = Motion::Zero();
  along.head(motions.cols()) = motions.transpose() * right;
  Matrix6 all = reduced(matrix, motions, matrix.trace());
  all.diagonal().array() += 1e-12 * matrix.trace() + 1e-300;
  const Spectrum<6> solved = spectrum(all);
  const Motion solution = solved.vectors * (solved.vectors.transpose() * along).cwiseQuotient(solved.values);
  return motions * solution.head(motions.cols());
}

Motion best_motion(const Correspondences& pairs, const Pivot& pivot, const Motions& motions, double cut) {
  Matrix6 matrix = Matrix6::Zero();
  Motion gradient = Motion::Zero();
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (!has_weight(pairs, i, cut)) continue;
    const Motion j = normal_motion(pairs.points[i], pairs.normals[i], pivot);
    matrix.noalias() += j * j.transpose();
    gradient += dot(pairs.normals[i], pairs.points[i] - pairs.closest[i]) * j;
  }
  Motion motion = -solved_within(matrix, motions, gradient);
  // A motion by a large part of the size is beyond the linearisation.
  constexpr double kLongest = 0.5;
  if (const double length = motion.norm(); length > kLongest * pivot.radius)
    motion *= kLongest * pivot.radius / length;
  return motion;
}

Affine moved(const Affine& pose, const Pivot& pivot, const Motion& motion) {
  const Eigen::Vector3d turn = motion.head<3>() / pivot.radius;
  const double angle = turn.norm();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (angle > 0) rotation = Eigen::AngleAxisd(angle, turn / angle);
  Eigen::Matrix3d before;
  for (int i = 0; i < 3; ++i) before.row(i) = vector(pose.rows[i]).transpose();
  // Through a quaternion of unit length, so that rounding does not add up to a shear.
  const Eigen::Matrix3d after = (rotation * Eigen::Quaterniond(before)).normalized().toRotationMatrix();
  Affine result;
  for (int i = 0; i < 3; ++i) result.rows[i] = vec3(after.row(i).transpose());
  result.offset = pivot.centre + vec3(rotation * vector(pose.offset - pivot.centre) + motion.tail<3>());
  return result;
}

}  // namespace sdm::registration
