// Times of repeated work, with their spread.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "research/figures/figure.h"

namespace sdm::figures {

/// Milliseconds of repeated runs. None: nothing was measured.
class Times {
 public:
  void add(double ms) { ms_.push_back(ms); }
  [[nodiscard]] bool empty() const { return ms_.empty(); }
  [[nodiscard]] double median() const;
  [[nodiscard]] double least() const;
  [[nodiscard]] double most() const;
  [[nodiscard]] std::size_t runs() const { return ms_.size(); }

  /// "12.3 ms (11.8 to 14.0, 5 runs)".
  [[nodiscard]] std::string text() const;
  /// "12.3 ms".
  [[nodiscard]] std::string median_text() const;

 private:
  std::vector<double> ms_;
};

/// {"median", "least", "most", "runs"}, or null if nothing was measured.
[[nodiscard]] Json to_json(const Times& times);

/// Returns the times of each kind of work. They take turns in each repetition, so that changes of the
/// machine's speed affect all alike; a first run of each, which allocates, is not counted if `warm` is set.
[[nodiscard]] std::vector<Times> take_turns(std::span<const std::function<void()>> work, int repetitions,
                                            bool warm = true);
/// The same for one.
[[nodiscard]] Times repeat(const std::function<void()>& work, int repetitions, bool warm = true);

/// The exponent p of the least-squares fit y = c·xᵖ; all values must be positive, at least two.
[[nodiscard]] double fitted_exponent(std::span<const double> x, std::span<const double> y);

}  // namespace sdm::figures
