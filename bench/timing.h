// Times of contenders that take turns, and statistics of times.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "harness.h"

namespace sdm::bench {

/// One of the computations that are timed side by side.
struct Contender {
  std::function<void()> work;
  unsigned threads = 1;  ///< that the library may use meanwhile; 0: one per core
};

/// Milliseconds per run of each contender's work: a list for each, with one value per repetition. All
/// contenders take their turn in every repetition, in alternating order, so that a change in the machine's
/// speed affects all alike. In each turn the work runs until `least_ms` have passed.
[[nodiscard]] std::vector<std::vector<double>> take_turns(std::span<const Contender> contenders,
                                                          int repetitions, double least_ms = 100);

/// The value below which a share of the values lies, interpolated.
[[nodiscard]] double quantile(std::vector<double> values, double share);
[[nodiscard]] double median(const std::vector<double>& values);
[[nodiscard]] double mean(std::span<const double> values);

/// How many times as long the peer takes as ours.
struct Race {
  double ratio;             ///< of the medians
  double spread;            ///< of the ratios of all repetitions: (third − first quartile) / median
  double ours_ms, peer_ms;  ///< medians

  /// "ratio", "spread", "ours_ms" and "peer_ms".
  [[nodiscard]] std::vector<Figure> figures() const;
};
[[nodiscard]] Race race(const Contender& ours, const Contender& peer, int repetitions);

}  // namespace sdm::bench
