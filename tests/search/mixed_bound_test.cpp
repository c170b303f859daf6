// Bounds on the smallest of several functions over a triangle.
#include "search/mixed_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace sdm::search {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

double largest(const CornerValues& values) {
  return *std::ranges::max_element(values);
}

// Linear functions, at many points of the triangle. The bound is the largest value itself, at the weights.
TEST(MixedBound, IsAboveTheSmallestFunctionEverywhere) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform;
  int smaller = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<CornerValues> functions(1 + trial % 6);
    for (CornerValues& values : functions)
      for (double& value : values) value = trial % 7 == 0 ? std::floor(3 * uniform(random)) : uniform(random);
    constexpr int kSteps = 40;
    double most = 0;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        double least = 1e9;
        for (const auto& [a, b, c] : functions)
          least = std::min(least, (i * a + j * b + (kSteps - i - j) * c) / kSteps);
        most = std::max(most, least);
      }
    const auto [bound, weights, mixed] = mixed_bound(functions, kNever);
    EXPECT_GE(bound, most - 1e-12);
    double best = 1e9;
    for (const CornerValues& values : functions) best = std::min(best, largest(values));
    EXPECT_LE(bound, best);
    double there = 1e9;  // at the weights
    for (const auto& [a, b, c] : functions)
      there = std::min(there, weights[0] * a + weights[1] * b + weights[2] * c);
    EXPECT_NEAR(bound, there, 1e-9);
    EXPECT_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-12);
    EXPECT_GE(*std::ranges::min_element(weights), 0);
    smaller += bound < best;
    std::vector<CornerValues> in_mean;
    for (const std::uint32_t f : mixed)
      if (f != kNone) in_mean.push_back(functions.at(f));
    EXPECT_NEAR(mixed_bound(in_mean, kNever).value, bound, 1e-9) << "the others are not needed";
    if (functions.size() == 2) {
      EXPECT_NEAR(bound, most, 2.0 / kSteps);
    }
    EXPECT_EQ(mixed_bound(functions, best).value, best);  // is enough
  }
  EXPECT_GT(smaller, 500);
  EXPECT_EQ(mixed_bound({}, 0).value, std::numeric_limits<double>::infinity());
}

// A single function is as large as at its largest corner, and there alone.
TEST(MixedBound, OfOneFunctionIsAtACorner) {
  for (int corner = 0; corner < 3; ++corner) {
    CornerValues values{1, 2, 3};
    std::swap(values[2], values[corner]);
    const MixedBound bound = mixed_bound({&values, 1}, kNever);
    EXPECT_EQ(bound.value, 3);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(bound.weights[k], k == corner ? 1 : 0);
  }
}

}  // namespace
}  // namespace sdm::search
