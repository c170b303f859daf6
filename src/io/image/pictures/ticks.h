// Numbers in pictures: round values along an axis, and their labels.
#pragma once

#include <string>
#include <vector>

namespace sdm::io {

/// The multiples in [lo, hi] of a round step, 1, 2 or 5 times a power of ten, close to (hi − lo) / count.
[[nodiscard]] std::vector<double> ticks(double lo, double hi, int count);
/// The label of a tick: short, but distinct from those of its neighbours, `step` away.
[[nodiscard]] std::string tick_label(double value, double step);
/// A number with four significant digits.
[[nodiscard]] std::string value_label(double value);

}  // namespace sdm::io
