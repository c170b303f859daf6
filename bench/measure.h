// Interleaved timing of several tasks.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace sdm::bench {

/// One of those that are timed side by side.
struct Contender {
  std::function<void()> work;
  unsigned threads = 1;  ///< that the library may use meanwhile; 0: one a core
};

/// Milliseconds a run of each contender's work: a list for each, with a value a repetition. In every
/// repetition all take their turn, so that a machine that slows down does so for all; a short work runs again
/// until a tenth of a second has passed. `name` is said with the progress, on stderr.
[[nodiscard]] std::vector<std::vector<double>> take_turns(const std::string& name,
                                                          std::span<const Contender> contenders,
                                                          int repetitions);

/// The value below which a share of the values lies, interpolated.
[[nodiscard]] double quantile(std::vector<double> values, double share);
[[nodiscard]] double median(const std::vector<double>& values);

/// Of two lists of times.
struct Ratio {
  double value = 0;   ///< of their medians
  double spread = 0;  ///< of the ratios of repetitions: (third − first quartile) / median
};
[[nodiscard]] Ratio ratio(std::span<const double> numerators, std::span<const double> denominators);

}  // namespace sdm::bench
