// Percentiles of weighted values, found by counting instead of sorting.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/parallel.h"

namespace sdm::map {

/// Finds percentiles in three passes over the values. Each adds up the weights by some further bits of a
/// value, from the highest on, of those values that share the bits found so far with a percentile. Exact, as
/// all bits of the value are known in the end; the weights are sums of doubles in an order that does not
/// depend on the number of threads.
class WeightedPercentiles {
 public:
  /// `for_each(part, visit)` must call visit(value, weight) for all values of a part, the same ones each
  /// time; values are finite, parts may be visited concurrently. There must be a value. Returns, for each of
  /// the ascending shares, the smallest value such that it and all smaller ones hold that share of the
  /// weight. Cost: linear, all cores.
  template <class ForEach>
  static std::vector<float> find(std::size_t parts, const ForEach& for_each, std::span<const double> shares) {
    std::vector<Place> places(shares.size());
    double total = 0;
    unsigned known = 0;  // bits
    for (const unsigned bits : {11u, 11u, 10u}) {
      const std::uint32_t entries = 1u << bits;
      const unsigned shift = 32 - known - bits;
      std::vector<std::uint32_t> prefixes;  // ascending, as the shares are
      for (const Place& place : places)
        if (prefixes.empty() || prefixes.back() != place.prefix) prefixes.push_back(place.prefix);
      const Weights weights = add_up(parts, prefixes.size() * entries, [&](std::size_t part, Weights& sums) {
        for_each(part, [&](float value, float weight) {
          const std::uint32_t high = key(value) >> shift, prefix = high >> bits;
          for (std::size_t i = 0; i < prefixes.size(); ++i)
            if (prefixes[i] == prefix) sums[i * entries + (high & (entries - 1))] += weight;
        });
      });
      if (known == 0)
        for (const double weight : weights) total += weight;
      for (std::size_t i = 0; i < places.size(); ++i) {
        Place& place = places[i];
        const auto row = std::ranges::find(prefixes, place.prefix) - prefixes.begin();
        const auto of_prefix = std::span(weights).subspan(static_cast<std::size_t>(row) * entries, entries);
        const auto [entry, below] = first_at_least(of_prefix, shares[i] * total - place.below);
        place = {place.prefix << bits | entry, place.below + below};
      }
      known += bits;
    }
    std::vector<float> result;
    for (const Place& place : places) result.push_back(value_of(place.prefix));
    return result;
  }

 private:
  using Weights = std::vector<double>;

  struct Place {
    std::uint32_t prefix = 0;  ///< the bits found, or one of the entries of a table
    double below = 0;          ///< the weight of all smaller values, or of all entries before it
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
  static Weights add_up(std::size_t parts, std::size_t entries, const Add& add) {
    std::vector<Weights> of_part(parts);
    parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part) {
        of_part[part].assign(entries, 0);
        add(part, of_part[part]);
      }
    });
    Weights sum = std::move(of_part[0]);
    for (std::size_t part = 1; part < parts; ++part)
      std::ranges::transform(sum, of_part[part], sum.begin(), std::plus());
    return sum;
  }

  // The entry at which the sum reaches `weight`; the last one that is not empty where rounding keeps the sum
  // below it.
  static Place first_at_least(std::span<const double> weights, double weight) {
    Place place;
    double sum = 0;
    for (std::uint32_t i = 0; i < weights.size() && (sum < weight || sum == 0); ++i)
      if (weights[i] > 0) {
        place = {i, sum};
        sum += weights[i];
      }
    return place;
  }
};

}  // namespace sdm::map
