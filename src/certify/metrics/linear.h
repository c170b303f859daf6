// Integrals and distributions of linear functions on triangles.
#pragma once

#include <sdm/types.h>

namespace sdm::metrics {

/// A linear function on a triangle, by its values at the corners.
class Linear {
 public:
  Linear() = default;
  explicit Linear(const Vec3& at_corners);

  /// The mean of the positive part, max(0, f).
  [[nodiscard]] double mean() const;
  /// The mean of the square of the positive part.
  [[nodiscard]] double mean_square() const;
  /// The fraction of the area where f ≤ limit.
  [[nodiscard]] double fraction_within(double limit) const;
  [[nodiscard]] double least() const { return a_; }
  [[nodiscard]] double largest() const { return c_; }

 private:
  /// The fraction of the area next to the corner with value `at`, up to where the function is `limit`.
  [[nodiscard]] double fraction_at(double at, double limit, double other, double third) const;

  double a_ = 0, b_ = 0, c_ = 0;  // ascending
};

}  // namespace sdm::metrics
