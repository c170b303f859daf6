#include "proximity/depth/mixed_bound.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace sdm::depth {
namespace {

// Each round mixes one more function in.
constexpr int kRounds = 3;

double largest(const CornerValues& values) {
  return std::max({values[0], values[1], values[2]});
}

// The mean of two functions whose largest value is smallest, if the first one is largest at corner `at`:
// along the weight, follows the largest of three lines until it no longer decreases.
CornerValues best_mean(const CornerValues& a, const CornerValues& b, int at) {
  const CornerValues slope{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  double weight = 0;
  while (slope[at] < 0 && weight < 1) {
    const double from = std::exchange(weight, 1.0);
    int next = at;
    for (int k = 0; k < 3; ++k)
      if (const double closing = slope[k] - slope[at]; closing > 0 && a[at] - a[k] < weight * closing)
        weight = std::max(from, (a[at] - a[k]) / closing), next = k;
    at = next;
  }
  return {a[0] + weight * slope[0], a[1] + weight * slope[1], a[2] + weight * slope[2]};
}

}  // namespace

double mixed_bound(std::span<const CornerValues> functions, double enough) {
  double bound = std::numeric_limits<double>::infinity();
  CornerValues mean{};
  for (const CornerValues& values : functions)
    if (const double most = largest(values); most < bound) bound = most, mean = values;
  for (int round = 0; round < kRounds && bound > enough; ++round) {
    const int at = mean[0] == bound ? 0 : mean[1] == bound ? 1 : 2;
    CornerValues best = mean;
    double least = bound;
    for (const CornerValues& values : functions) {
      if (!(values[at] < mean[at])) continue;
      const CornerValues candidate = best_mean(mean, values, at);
      if (const double most = largest(candidate); most < least) least = most, best = candidate;
    }
    if (!(least < bound)) break;
    bound = least, mean = best;
  }
  return bound;
}

}  // namespace sdm::depth
