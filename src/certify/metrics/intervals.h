// Limits that a number known from independent random samples exceeds with a small probability, `miss`,
// whatever the number of samples and their distribution.
#pragma once

#include <cstdint>

namespace sdm::metrics {

/// The probability that at most k of n independent trials succeed, each with probability p.
[[nodiscard]] double at_most(std::uint64_t n, std::uint64_t k, double p);

/// The largest k such that the k-th least of n samples is above their p-quantile, the least t with P(d ≤ t) ≥
/// p, with probability `miss` at most; 0: none.
[[nodiscard]] std::uint64_t rank_below(std::uint64_t n, double p, double miss);
/// The least k such that the k-th least of n samples is below their p-quantile with probability `miss` at
/// most; n + 1: none.
[[nodiscard]] std::uint64_t rank_above(std::uint64_t n, double p, double miss);

/// Limits on the probability of what k of n samples have (C. Clopper and E. Pearson, 1934).
[[nodiscard]] double least_share(std::uint64_t n, std::uint64_t k, double miss);
[[nodiscard]] double most_share(std::uint64_t n, std::uint64_t k, double miss);

/// How far the mean of n samples in an interval of this length may be above, and how far below, that of all
/// (A. Maurer and M. Pontil, Empirical Bernstein Bounds and Sample Variance Penalization, 2009, theorem 4).
/// `variance`: of the samples, their squared deviations divided by n − 1.
struct MeanDeviation {
  double of_deviation = 0;  ///< decreases with √n
  double of_range = 0;      ///< decreases with n
  [[nodiscard]] double sum() const { return of_deviation + of_range; }
};
[[nodiscard]] MeanDeviation mean_deviation(std::uint64_t n, double variance, double range, double miss);

}  // namespace sdm::metrics
