#include "io/write/ticks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sdm {

std::vector<double> ticks(double lo, double hi, int count) {
  const double rough = (hi - lo) / count;
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (const double round : {1.0, 2.0, 5.0})
    if (rough <= round * decade) {
      step = round * decade;
      break;
    }
  std::vector<double> result;
  // Counted, not added up: values far from zero may not change by a step.
  const double first = std::ceil(lo / step - 1e-9);
  for (int i = 0; i <= 2 * count; ++i) {
    const double value = (first + i) * step;
    if (value > hi + 1e-9 * step) break;
    result.push_back(value == 0 ? 0 : value);
  }
  return result;
}

std::string tick_label(double value, double step) {
  char text[64];
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) {
    const int digits =
        std::clamp(static_cast<int>(std::floor(std::log10(size)) - std::floor(std::log10(step))), 0, 15);
    std::snprintf(text, sizeof text, "%.*e", digits, value);
  } else {
    std::snprintf(text, sizeof text, "%.*f",
                  std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15), value);
  }
  std::string result = text;
  if (const auto minus = result.find('-'); minus == 0) result.replace(0, 1, "\u2212");
  return result;
}

}  // namespace sdm
