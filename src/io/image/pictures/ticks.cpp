#include "io/image/pictures/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "summary/round_step.h"

namespace sdm::io {
namespace {

// Replaces a leading hyphen with a minus sign.
std::string with_minus_sign(std::string number) {
  if (number.starts_with('-')) number.replace(0, 1, "\u2212");
  return number;
}

}  // namespace

std::vector<double> ticks(double lo, double hi, int count) {
  const RoundStep step((hi - lo) / count);
  std::vector<double> result;
  // Multiplied rather than accumulated: far from zero, adding a step may not change a value.
  const double first = std::ceil(lo / step.size() - 1e-9);
  for (int i = 0; i <= 2 * count; ++i) {
    const double value = step.multiple(first + i);
    if (value > hi + 1e-9 * step.size()) break;
    result.push_back(value == 0 ? 0 : value);
  }
  return result;
}

std::string tick_label(double value, double step) {
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4)
    return with_minus_sign(fmt::format(
        "{:.{}e}", value,
        std::clamp(static_cast<int>(std::floor(std::log10(size)) - std::floor(std::log10(step))), 0, 15)));
  return with_minus_sign(fmt::format(
      "{:.{}f}", value, std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15)));
}

std::string value_label(double value) {
  return with_minus_sign(fmt::format("{:.4g}", value));
}

}  // namespace sdm::io
