#include "certify/metrics/intervals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sdm::metrics {
namespace {

// ln n!: std::lgamma() is not safe in several threads.
double log_factorial(double n) {
  constexpr double kFew = 16;
  if (n < kFew) {
    double product = 1;
    for (double i = 2; i <= n; ++i) product *= i;
    return std::log(product);
  }
  const double square = n * n;
  const double series = (1.0 / 12 - (1.0 / 360 - 1.0 / 1260 / square) / square) / n;  // Stirling's
  return (n + 0.5) * std::log(n) - n + 0.5 * std::log(2 * std::numbers::pi) + series;
}

}  // namespace

double at_most(std::uint64_t n, std::uint64_t k, double p) {
  if (k >= n || !(p > 0)) return 1;
  if (!(p < 1)) return 0;
  const auto trials = static_cast<double>(n), successes = static_cast<double>(k);
  if (successes >= trials * p) return 1 - at_most(n, n - k - 1, 1 - p);
  // Terms decrease from k downwards.
  constexpr double kNegligible = 1e-18;
  double sum = 1, term = 1;
  for (double i = successes; i > 0; --i) {
    const double ratio = i / (trials - i + 1) * ((1 - p) / p);
    term *= ratio;
    sum += term;
    if (term < kNegligible * sum * (1 - ratio)) break;
  }
  const double first = log_factorial(trials) - log_factorial(successes) - log_factorial(trials - successes) +
                       successes * std::log(p) + (trials - successes) * std::log1p(-p);
  return std::min(1.0, std::exp(first) * sum);
}

// Fewer than k samples are at most the quantile.
std::uint64_t rank_below(std::uint64_t n, double p, double miss) {
  std::uint64_t low = 0, high = n + 1;
  while (high - low > 1) {
    const std::uint64_t k = low + (high - low) / 2;
    (at_most(n, k - 1, p) <= miss ? low : high) = k;
  }
  return low;
}

std::uint64_t rank_above(std::uint64_t n, double p, double miss) {
  return n + 1 - rank_below(n, 1 - p, miss);
}

double most_share(std::uint64_t n, std::uint64_t k, double miss) {
  if (k >= n) return 1;
  double low = static_cast<double>(k) / static_cast<double>(n), high = 1;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = low + (high - low) / 2;
    (at_most(n, k, middle) <= miss ? high : low) = middle;
  }
  return high;
}

double least_share(std::uint64_t n, std::uint64_t k, double miss) {
  return 1 - most_share(n, n - k, miss);
}

MeanDeviation mean_deviation(std::uint64_t n, double variance, double range, double miss) {
  const double logarithm = std::log(2 / miss), samples = static_cast<double>(n);
  return {std::sqrt(2 * variance * logarithm / samples), 7 * range * logarithm / (3 * (samples - 1))};
}

}  // namespace sdm::metrics
