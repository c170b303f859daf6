// Steps between round numbers.
#pragma once

#include "core/rules.h"

namespace sdm {

inline constexpr int kScaleSteps = static_cast<int>(rules::kScaleSteps);

/// The least of 1, 2, 5 and 10 times a power of ten that is not smaller than a positive number.
class RoundStep {
 public:
  explicit RoundStep(double least)
      : digit_(rules::step_digit(least)), exponent_(rules::step_exponent(least)) {}

  [[nodiscard]] double size() const { return multiple(1); }
  /// The double that is nearest to n steps, where the power of ten is one.
  [[nodiscard]] double multiple(double n) const { return rules::step_multiple(n, digit_, exponent_); }

 private:
  double digit_, exponent_;
};

}  // namespace sdm
