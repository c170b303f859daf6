// Numbers and lengths as text.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

/// The shortest form with at most this many significant digits.
[[nodiscard]] inline std::string number(double value, int digits = 5) {
  return fmt::format("{:.{}g}", value, digits);
}

/// For example " mm" for the units "mm"; empty without units.
[[nodiscard]] inline std::string unit_suffix(std::string_view units) {
  return units.empty() ? std::string() : fmt::format(" {}", units);
}
