#include "timing.h"

#include <sdm/execution.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/stopwatch.h"

namespace sdm::bench {
namespace {

double time_of(const Contender& contender, double least_ms) {
  const ThreadLimit limit(contender.threads);
  Stopwatch watch;
  double elapsed = 0;
  int runs = 0;
  do {
    contender.work();
    elapsed += watch.lap();
    ++runs;
  } while (elapsed < least_ms);
  return elapsed / runs;
}

}  // namespace

std::vector<std::vector<double>> take_turns(std::span<const Contender> contenders, int repetitions,
                                            double least_ms) {
  std::vector<std::vector<double>> times(contenders.size());
  for (int i = 0; i < repetitions; ++i)
    for (std::size_t turn = 0; turn < contenders.size(); ++turn) {
      const std::size_t k = i % 2 == 0 ? turn : contenders.size() - 1 - turn;
      times[k].push_back(time_of(contenders[k], least_ms));
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

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<Figure> Race::figures() const {
  return {{"ratio", ratio}, {"spread", spread}, {"ours_ms", ours_ms}, {"peer_ms", peer_ms}};
}

Race race(const Contender& ours, const Contender& peer, int repetitions) {
  const auto times = take_turns(std::array{ours, peer}, repetitions);
  std::vector<double> ratios(times[0].size());
  std::ranges::transform(times[1], times[0], ratios.begin(), std::divides{});
  const double ours_ms = median(times[0]), peer_ms = median(times[1]);
  return {.ratio = peer_ms / ours_ms,
          .spread = (quantile(ratios, 0.75) - quantile(ratios, 0.25)) / median(ratios),
          .ours_ms = ours_ms,
          .peer_ms = peer_ms};
}

}  // namespace sdm::bench
