// Barycentric coordinates of points of triangles.
#pragma once

#include <algorithm>
#include <limits>

#include "geometry/triangle.h"

namespace sdm::core {

/// The barycentric coordinates of points of a triangle.
///
/// Of the longest side ab, with s and t the parameters on it of p and of the third corner c, and w the share
/// of c's height that p has, the coordinates are w of c and s − w t of b. An error of w moves the point
/// across the side, by at most the height of c. Beyond a corner of ab, either s − w t or w is limited to what
/// the triangle contains: whichever moves the point less.
class BarycentricFrame {
 public:
  BarycentricFrame() = default;
  explicit BarycentricFrame(const Corners& corners) : corners_(corners) {
    for (std::size_t k = 0; k < 3; ++k)
      if (const double length = squared_norm(corners[(k + 1) % 3] - corners[k]); length > longest_) {
        from_ = k;
        longest_ = length;
      }
    if (!(longest_ > kLeast)) return;
    per_longest_ = 1 / longest_;
    side_ = corners[to()] - corners[from_];
    t_ = dot(corners[third()] - corners[from_], side_) * per_longest_;
    height_ = corners[third()] - corners[from_] - t_ * side_;
    const double squared_height = squared_norm(height_);
    if (squared_height > kLeast)
      height_ = 1 / squared_height * height_;
    else
      height_ = {};
  }

  /// The coordinates of the triangle's point under p: not negative, with a sum of 1 up to rounding, also if
  /// p lies beside the triangle by rounding, or the triangle has no area. The point that they give is as
  /// accurate as p, also in needles, where ratios of areas are rounding errors.
  [[nodiscard]] Vec3 weights(const Vec3& p) const {
    if (!(longest_ > kLeast)) return {1, 0, 0};
    const Vec3 from = p - corners_[from_];
    const double s = dot(from, side_) * per_longest_;
    const double w = std::clamp(dot(from - s * side_, height_), 0.0, 1.0);
    const Vec3 weights = weights_for(s, w);
    if ((t_ <= 0 || w * t_ <= s) && (t_ >= 1 || w * (1 - t_) <= 1 - s)) return weights;
    const double most = std::max(0.0, std::min(t_ > 0 ? s / t_ : 1, t_ < 1 ? (1 - s) / (1 - t_) : 1));
    if (w <= most) return weights;
    const Vec3 limited = weights_for(s, most);
    return error(limited, p) < error(weights, p) ? limited : weights;
  }

 private:
  [[nodiscard]] std::size_t to() const { return (from_ + 1) % 3; }
  [[nodiscard]] std::size_t third() const { return (from_ + 2) % 3; }
  [[nodiscard]] Vec3 weights_for(double s, double of_third) const {
    Vec3 weights;
    weights[third()] = of_third;
    weights[to()] = std::clamp(s - of_third * t_, 0.0, 1 - of_third);
    weights[from_] = std::max(0.0, 1 - of_third - weights[to()]);
    return weights;
  }
  [[nodiscard]] double error(const Vec3& v, const Vec3& p) const {
    return squared_norm(v[0] * corners_[0] + v[1] * corners_[1] + v[2] * corners_[2] - p);
  }

  /// The least squared length whose inverse is finite; what is shorter than its root counts as 0.
  static constexpr double kLeast = std::numeric_limits<double>::min();

  Corners corners_{};
  std::size_t from_ = 0;    ///< the corner where the longest side begins
  double longest_ = -1;     ///< its squared length
  double per_longest_ = 0;  ///< its inverse
  Vec3 side_{}, height_{};  ///< the height divided by its squared length
  double t_ = 0;
};

/// BarycentricFrame::weights() of one point.
inline Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  return BarycentricFrame({a, b, c}).weights(p);
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
