#include "research/figures/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"

namespace sdm::figures {
namespace {

/// Three digits, or all before the point.
std::string digits(double ms) {
  return ms < 1000 ? fmt::format("{:.3g}", ms) : fmt::format("{:.0f}", ms);
}

}  // namespace

double Times::median() const {
  std::vector<double> sorted = ms_;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  return n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

double Times::least() const {
  return *std::ranges::min_element(ms_);
}

double Times::most() const {
  return *std::ranges::max_element(ms_);
}

std::string Times::median_text() const {
  return empty() ? "not measured" : digits(median()) + " ms";
}

std::string Times::text() const {
  if (runs() < 2) return median_text() + (empty() ? "" : " (1 run)");
  return fmt::format("{} ({} to {}, {} runs)", median_text(), digits(least()), digits(most()), runs());
}

Json to_json(const Times& times) {
  if (times.empty()) return nullptr;
  return {
      {"median", times.median()}, {"least", times.least()}, {"most", times.most()}, {"runs", times.runs()}};
}

std::vector<Times> take_turns(std::span<const std::function<void()>> work, int repetitions, bool warm) {
  std::vector<Times> times(work.size());
  if (warm)
    for (const auto& run : work) run();
  for (int i = 0; i < repetitions; ++i)
    for (std::size_t k = 0; k < work.size(); ++k) {
      Stopwatch watch;
      work[k]();
      times[k].add(watch.lap());
    }
  return times;
}

Times repeat(const std::function<void()>& work, int repetitions, bool warm) {
  return take_turns(std::span(&work, 1), repetitions, warm)[0];
}

double fitted_exponent(std::span<const double> x, std::span<const double> y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a;
    sy += b;
    sxx += a * a;
    sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace sdm::figures
