// Timing of contenders that take turns, and statistics of times.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "harness.h"

namespace sdm::bench {

/// One of several computations timed side by side.
struct Contender {
  std::function<void()> work;
  unsigned threads = 1;  ///< the number of threads the library may use; 0: one per core
};

/// Measures the milliseconds per run of each contender's work: a list for each, with one value per
/// repetition. All contenders take turns in every repetition, in alternating order, so that changes in the
/// machine's speed affect all of them equally. In each turn the work is repeated until `least_ms` have
/// passed.
[[nodiscard]] std::vector<std::vector<double>> take_turns(std::span<const Contender> contenders,
                                                          int repetitions, double least_ms = 100);

/// The quantile: the value below which the fraction `share` of the values lies, interpolated.
[[nodiscard]] double quantile(std::vector<double> values, double share);
[[nodiscard]] double median(const std::vector<double>& values);
[[nodiscard]] double mean(std::span<const double> values);

/// The peer's time relative to ours.
struct Race {
  double ratio;             ///< of the medians
  double spread;            ///< of the ratios over repetitions: (third − first quartile) / median
  double ours_ms, peer_ms;  ///< medians

  /// "ratio", "spread", "ours_ms" and "peer_ms".
  [[nodiscard]] std::vector<Figure> figures() const;
};
[[nodiscard]] Race race(const Contender& ours, const Contender& peer, int repetitions);

}  // namespace sdm::bench
