#include "registration/principal_axes.h"

#include <algorithm>
#include <cmath>

#include "registration/eigen.h"

namespace sdm::registration {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

Vec3 median_point(std::span<const Vec3> points) {
  Vec3 result;
  std::vector<double> values(points.size());
  for (int k = 0; k < 3; ++k) {
    std::ranges::transform(points, values.begin(), [k](const Vec3& p) { return p[k]; });
    result[k] = median(values);
  }
  return result;
}

// The points within five times the median distance of the median.
std::vector<Vec3> core_of(std::span<const Vec3> points, const Vec3& centre) {
  constexpr double kFar = 5;
  std::vector<double> distances(points.size());
  std::ranges::transform(points, distances.begin(), [&](const Vec3& p) { return norm(p - centre); });
  const double limit = kFar * median(distances);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (distances[i] <= limit) result.push_back(points[i]);
  return result;
}

struct Axes {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d columns;  ///< right-handed, by increasing moments
  bool ambiguous = false;
};

Axes axes_of(std::span<const Vec3> points) {
  const std::vector<Vec3> core = core_of(points, median_point(points));
  Axes axes;
  for (const Vec3& p : core) axes.mean += vector(p);
  axes.mean /= static_cast<double>(core.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& p : core) covariance += (vector(p) - axes.mean) * (vector(p) - axes.mean).transpose();
  const Spectrum<3> principal = spectrum(covariance);
  axes.columns = principal.vectors;
  if (axes.columns.determinant() < 0) axes.columns.col(0) *= -1;
  constexpr double kAlike = 0.75;
  axes.ambiguous = principal.values[0] > kAlike * principal.values[1] ||
                   principal.values[1] > kAlike * principal.values[2];
  return axes;
}

}  // namespace

AxisMatches axis_matches(std::span<const Vec3> from, std::span<const Vec3> to) {
  const Axes a = axes_of(from), b = axes_of(to);
  AxisMatches result;
  if (a.ambiguous || b.ambiguous) result.likely = 24;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d match = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) match(order[k], k) = signs >> k & 1 ? -1 : 1;
      if (match.determinant() < 0) continue;
      const Eigen::Matrix3d rotation = b.columns * match * a.columns.transpose();
      Affine pose;
      for (int k = 0; k < 3; ++k) pose.rows[k] = vec3(rotation.row(k).transpose());
      pose.offset = vec3(b.mean - rotation * a.mean);
      result.poses.push_back(pose);
    }
  } while (std::ranges::next_permutation(order).found);
  return result;
}

Extent robust_extent(std::span<const Vec3> points) {
  Extent result{median_point(points), 0};
  const std::vector<Vec3> core = core_of(points, result.centre);
  for (const Vec3& p : core) result.radius += squared_norm(p - result.centre);
  result.radius = std::sqrt(result.radius / static_cast<double>(core.size()));
  return result;
}

}  // namespace sdm::registration
