// Steps between round numbers.
#pragma once

#include <cmath>

namespace sdm {

inline constexpr int kScaleSteps = 10;  ///< of scales of colours, at most

/// The least of 1, 2, 5 and 10 times a power of ten that is not smaller than a positive number.
class RoundStep {
 public:
  explicit RoundStep(double least) : exponent_(static_cast<int>(std::floor(std::log10(least)))) {
    for (const double digit : {1.0, 2.0, 5.0, 10.0}) {
      digit_ = digit;
      if (least <= multiple(1) * (1 + 1e-12)) break;
    }
  }

  [[nodiscard]] double size() const { return multiple(1); }
  /// The double that is nearest to n steps, where the power of ten is one: 3 steps of 0.1 are 0.3.
  [[nodiscard]] double multiple(double n) const {
    const double power = std::pow(10.0, std::abs(exponent_));
    return exponent_ < 0 ? n * digit_ / power : n * digit_ * power;
  }
  [[nodiscard]] double below(double x) const { return multiple(std::floor(x / size() + 1e-9)) + 0.0; }
  [[nodiscard]] double above(double x) const { return multiple(std::ceil(x / size() - 1e-9)) + 0.0; }

 private:
  double digit_ = 1;
  int exponent_;
};

}  // namespace sdm
