// Sums of many numbers.
#pragma once

#include <cmath>

namespace sdm::core {

/// A sum whose rounding error does not grow with the number of terms (A. Neumaier, Rundungsfehleranalyse
/// einiger Verfahren zur Summation endlicher Summen, 1974). With u = 2⁻⁵³, that of n terms is at most u times
/// the sum and 2·(n·u)² times the sum of the magnitudes.
class CompensatedSum {
 public:
  void operator+=(double x) {
    const double sum = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
    sum_ = sum;
  }
  [[nodiscard]] double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
