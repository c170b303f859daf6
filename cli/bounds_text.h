// Bounds as text, rounded outwards: a printed bound holds as the computed one does.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "format.h"

/// The largest number of at most this many significant digits that is not greater.
[[nodiscard]] inline std::string lower_number(double value, int digits = 5) {
  std::string text = number(value, digits);
  // One unit of the last digit less than the nearest such number, which is greater.
  if (const double nearest = std::strtod(text.c_str(), nullptr); nearest > value)
    text = number(nearest - std::pow(10, std::floor(std::log10(std::abs(value))) + 1 - digits), digits);
  return text;
}

/// The least number of at most this many significant digits that is not less.
[[nodiscard]] inline std::string upper_number(double value, int digits = 5) {
  const std::string text = lower_number(-value, digits);
  if (text.front() == '-') return text.substr(1);
  return text == "0" ? text : "-" + text;
}

/// "between LOWER and UPPER".
[[nodiscard]] inline std::string bounds_text(double lower, double upper, int digits = 5) {
  return fmt::format("between {} and {}", lower_number(lower, digits), upper_number(upper, digits));
}
