#include "measure.h"

#include <sdm/threads.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/stopwatch.h"

namespace sdm::bench {
namespace {

double time_of(const Contender& contender) {
  constexpr double kLongEnough = 100;  // milliseconds, far above what a scheduler takes away
  const ThreadLimit limit(contender.threads);
  Stopwatch watch;
  double elapsed = 0;
  int runs = 0;
  for (; elapsed < kLongEnough; ++runs) {
    contender.work();
    elapsed += watch.lap();
  }
  return elapsed / runs;
}

}  // namespace

std::vector<std::vector<double>> take_turns(const std::string& name, std::span<const Contender> contenders,
                                            int repetitions) {
  std::vector<std::vector<double>> times(contenders.size());
  for (int i = 0; i < repetitions; ++i) {
    std::fprintf(stderr, "%s: repetition %d of %d\n", name.c_str(), i + 1, repetitions);
    for (std::size_t turn = 0; turn < contenders.size(); ++turn) {
      // Back and forth, so that none always follows the same other.
      const std::size_t k = i % 2 == 0 ? turn : contenders.size() - 1 - turn;
      times[k].push_back(time_of(contenders[k]));
    }
  }
  return times;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

double median(const std::vector<double>& values) {
  return quantile(values, 0.5);
}

Ratio ratio(std::span<const double> numerators, std::span<const double> denominators) {
  std::vector<double> ratios(numerators.size());
  std::ranges::transform(numerators, denominators, ratios.begin(), std::divides{});
  return {.value = median({numerators.begin(), numerators.end()}) /
                   median({denominators.begin(), denominators.end()}),
          .spread = (quantile(ratios, 0.75) - quantile(ratios, 0.25)) / median(ratios)};
}

}  // namespace sdm::bench
