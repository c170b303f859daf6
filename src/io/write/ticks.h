// Numbers in pictures: round ones along an axis, and their labels.
#pragma once

#include <string>
#include <vector>

namespace sdm::io {

/// Round numbers (1, 2 or 5 times a power of ten) apart by about a `count`-th of [lo, hi], all within.
[[nodiscard]] std::vector<double> ticks(double lo, double hi, int count);
/// The label of a tick: short, but distinct from its neighbours, which are `step` away.
[[nodiscard]] std::string tick_label(double value, double step);
/// A number with four significant digits.
[[nodiscard]] std::string value_label(double value);

}  // namespace sdm::io
