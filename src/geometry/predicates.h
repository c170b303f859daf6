// Exact orientation predicates.
#pragma once

#include <sdm/types.h>

#include <cmath>

#include "geometry/rounding.h"

namespace sdm::core {

/// The sign of (d − a)·((b − a) × (c − a)): 1 if a, b, c are counter-clockwise seen from d, −1 if they are
/// clockwise, 0 if d lies in their plane or they are collinear. Exact for all finite coordinates. Cost: about
/// twenty operations; big integers only where rounding could change the sign.
[[nodiscard]] int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// orientation(a, b, c, d) of several points d, with what they share computed once. Refers to a, b and c.
class OrientedPlane {
 public:
  OrientedPlane(const Vec3& a, const Vec3& b, const Vec3& c) : a_(a), b_(b), c_(c) {
    const Vec3 u = b - a, v = c - a;
    for (int k = 0; k < 3; ++k) {
      const int i = k < 2 ? k + 1 : 0, j = k > 0 ? k - 1 : 2;
      const double plus = u[i] * v[j], minus = u[j] * v[i];
      normal_[k] = plus - minus;
      magnitude_[k] = std::abs(plus) + std::abs(minus);
    }
  }
  [[nodiscard]] int side(const Vec3& d) const {
    const Vec3 w = d - a_;
    const double determinant = dot(w, normal_);
    const double magnitude = dot({std::abs(w[0]), std::abs(w[1]), std::abs(w[2])}, magnitude_);
    if (std::abs(determinant) > kError3 * magnitude + kUnderflow) return determinant > 0 ? 1 : -1;
    return side_by_more_digits(d, magnitude);
  }

 private:
  [[nodiscard]] int side_by_more_digits(const Vec3& d, double magnitude) const;

  const Vec3 &a_, &b_, &c_;
  Vec3 normal_, magnitude_;  // (b − a) × (c − a), and the sums of its magnitudes
};

/// The sign of (b − a) × (c − a): 1 if c is to the left of the line from a to b. Exact.
[[nodiscard]] int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
