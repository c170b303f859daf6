#include "certify/metrics/linear.h"

#include <algorithm>

namespace sdm::metrics {
namespace {

double mean_of(double a, double b, double c) {
  return (a + b + c) / 3;
}

double mean_square_of(double a, double b, double c) {
  return (a * a + b * b + c * c + a * b + b * c + c * a) / 6;
}

}  // namespace

Linear::Linear(const Vec3& at_corners) : a_(at_corners[0]), b_(at_corners[1]), c_(at_corners[2]) {
  if (a_ > b_) std::swap(a_, b_);
  if (b_ > c_) std::swap(b_, c_);
  if (a_ > b_) std::swap(a_, b_);
}

// The triangle next to a corner is similar to the whole one along both sides.
double Linear::fraction_at(double at, double limit, double other, double third) const {
  return (limit - at) / (other - at) * ((limit - at) / (third - at));
}

double Linear::fraction_within(double limit) const {
  if (limit >= c_) return 1;
  if (limit <= a_) return 0;
  return limit <= b_ ? fraction_at(a_, limit, b_, c_) : 1 - fraction_at(c_, limit, a_, b_);
}

// The part next to a corner with the other sign has the values (a, 0, 0) at its corners.
double Linear::mean() const {
  if (a_ >= 0) return mean_of(a_, b_, c_);
  if (c_ <= 0) return 0;
  if (b_ > 0) return mean_of(a_, b_, c_) - fraction_at(a_, 0, b_, c_) * mean_of(a_, 0, 0);
  return fraction_at(c_, 0, a_, b_) * mean_of(c_, 0, 0);
}

double Linear::mean_square() const {
  if (a_ >= 0) return mean_square_of(a_, b_, c_);
  if (c_ <= 0) return 0;
  if (b_ > 0) return mean_square_of(a_, b_, c_) - fraction_at(a_, 0, b_, c_) * mean_square_of(a_, 0, 0);
  return fraction_at(c_, 0, a_, b_) * mean_square_of(c_, 0, 0);
}

double TwoSided::fraction_within(double limit) const {
  const double a = a_.fraction_within(limit), b = b_.fraction_within(limit);
  return a == 1 ? b : b == 1 ? a : std::max(0.0, a + b - 1);
}

double TwoSided::least() const {
  return std::max({0.0, a_.least(), b_.least()});
}

double TwoSided::largest() const {
  return std::max({0.0, a_.largest(), b_.largest()});
}

}  // namespace sdm::metrics
