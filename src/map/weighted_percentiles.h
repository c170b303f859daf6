// Percentiles of weighted values, found by counting instead of sorting.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/parallel.h"

namespace sdm::map {

/// Finds percentiles in two passes over the values: the first adds up the weights by the upper half of a
/// value's bits, the second by the lower half within the intervals that hold a percentile. Exact, as all bits
/// of the value are then known; the weights are sums of doubles in an order that does not depend on the
/// number of threads.
class WeightedPercentiles {
 public:
  /// `for_each(part, visit)` must call visit(value, weight) for all values of a part, the same ones each
  /// time; values are finite, parts may be visited concurrently. There must be a value. Returns, for each of
  /// the ascending shares, the smallest value such that it and all smaller ones hold that share of the
  /// weight. Cost: linear, all cores.
  template <class ForEach>
  static std::vector<float> find(std::size_t parts, const ForEach& for_each, std::span<const double> shares) {
    const Histogram coarse = add_up(parts, 1, [&](std::size_t part, Histogram& weights) {
      for_each(part, [&](float value, float weight) { weights[key(value) >> kBits] += weight; });
    });
    double total = 0;
    for (const double weight : coarse) total += weight;

    std::vector<Place> places;                       // the interval of each share
    std::array<std::uint8_t, kIntervals> fine_of{};  // 1 + the number of the interval among those refined
    std::size_t intervals = 0;
    for (const double share : shares) {
      const Place& place = places.emplace_back(first_at_least(coarse, share * total));
      if (fine_of[place.index] == 0) fine_of[place.index] = static_cast<std::uint8_t>(++intervals);
    }
    const Histogram fine = add_up(parts, intervals, [&](std::size_t part, Histogram& weights) {
      for_each(part, [&](float value, float weight) {
        const std::uint32_t k = key(value);
        if (const std::size_t interval = fine_of[k >> kBits]; interval > 0)
          weights[(interval - 1) * kIntervals + (k & (kIntervals - 1))] += weight;
      });
    });

    std::vector<float> result;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const std::span weights =
          std::span(fine).subspan((fine_of[places[i].index] - std::size_t{1}) * kIntervals, kIntervals);
      const Place place = first_at_least(weights, shares[i] * total - places[i].below);
      result.push_back(value_of(static_cast<std::uint32_t>(places[i].index << kBits | place.index)));
    }
    return result;
  }

 private:
  static constexpr unsigned kBits = 16;
  static constexpr std::size_t kIntervals = std::size_t{1} << kBits;
  using Histogram = std::vector<double>;

  struct Place {
    std::size_t index;
    double below;  ///< the weight of all entries before it
  };

  // The bits of a float as a number whose order is that of the floats.
  static std::uint32_t key(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits ^ (bits >> 31 ? 0xFFFFFFFFu : 0x80000000u);
  }
  static float value_of(std::uint32_t key) {
    return std::bit_cast<float>(key ^ (key >> 31 ? 0x80000000u : 0xFFFFFFFFu));
  }

  template <class Add>
  static Histogram add_up(std::size_t parts, std::size_t intervals, const Add& add) {
    std::vector<Histogram> of_part(parts);
    parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part) {
        of_part[part].assign(intervals * kIntervals, 0);
        add(part, of_part[part]);
      }
    });
    Histogram sum = std::move(of_part[0]);
    for (std::size_t part = 1; part < parts; ++part)
      std::ranges::transform(sum, of_part[part], sum.begin(), std::plus());
    return sum;
  }

  // The entry at which the sum reaches `weight`; the last one that is not empty where rounding keeps the sum
  // below it.
  static Place first_at_least(std::span<const double> weights, double weight) {
    Place place{0, 0};
    double sum = 0;
    for (std::size_t i = 0; i < weights.size() && (sum < weight || sum == 0); ++i)
      if (weights[i] > 0) {
        place = {i, sum};
        sum += weights[i];
      }
    return place;
  }
};

}  // namespace sdm::map
