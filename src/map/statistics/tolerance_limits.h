// Which distances are out of a tolerance although they are rounded.
#pragma once

#include <sdm/tolerance.h>

#include <cmath>

namespace sdm::map {

/// A computed distance d stands for those from d − accuracy to d + accuracy; if |d| ≤ accuracy, its sign is
/// not certain either.
class ToleranceLimits {
 public:
  ToleranceLimits(const Tolerance& tolerance, double accuracy)
      : lo_(tolerance.lo - accuracy), hi_(tolerance.hi + accuracy), accuracy_(accuracy) {}

  [[nodiscard]] bool below(double d) const { return (is_zero(d) ? std::abs(d) : d) < lo_; }
  [[nodiscard]] bool above(double d) const { return (is_zero(d) ? -std::abs(d) : d) > hi_; }

 private:
  [[nodiscard]] bool is_zero(double d) const { return std::abs(d) <= accuracy_; }

  double lo_, hi_, accuracy_;
};

}  // namespace sdm::map
