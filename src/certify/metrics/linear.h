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

/// max(0, a, b) of two linear functions: the distance to a plane, or between two, where a triangle crosses
/// it. Exact unless a and b are both positive somewhere; then the mean and the mean square are upper bounds,
/// and the fraction within a limit is a lower one.
class TwoSided {
 public:
  TwoSided(const Vec3& a, const Vec3& b) : a_(a), b_(b) {}

  [[nodiscard]] double mean() const { return a_.mean() + b_.mean(); }
  [[nodiscard]] double mean_square() const { return a_.mean_square() + b_.mean_square(); }
  [[nodiscard]] double fraction_within(double limit) const;
  [[nodiscard]] double least() const;
  [[nodiscard]] double largest() const;

 private:
  Linear a_, b_;
};

}  // namespace sdm::metrics
