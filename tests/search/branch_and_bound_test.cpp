// The largest value of functions of one variable, whose slopes are bounded.
#include "search/branch_and_bound.h"

#include <gtest/gtest.h>
#include <sdm/execution.h>

#include <array>
#include <atomic>
#include <random>

namespace sdm::search {
namespace {

struct Interval {
  double begin = 0, end = 1, upper = std::numeric_limits<double>::infinity();
};
struct Values {
  std::vector<double> at_middle;
};

struct Waves : Policy {
  static constexpr std::size_t kLeast = 8, kFraction = 3, kRun = 4;
  std::vector<std::array<double, 3>> waves;
  Parts<Interval, Values> parts;
  std::size_t evaluated = 0, budget = std::numeric_limits<std::size_t>::max();

  explicit Waves(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < 12; ++i)
      waves.push_back({uniform(random), 60 * uniform(random), 6 * uniform(random)});
  }
  [[nodiscard]] double value(double x) const {
    double sum = 0;
    for (const auto& [height, frequency, phase] : waves) sum += height * std::cos(frequency * x + phase);
    return sum;
  }
  [[nodiscard]] double slope() const {
    double sum = 0;
    for (const auto& [height, frequency, phase] : waves) sum += height * frequency;
    return sum;
  }
  void evaluate(std::span<const Interval> run, Values& found) const {
    found.at_middle.clear();
    for (const Interval& part : run) found.at_middle.push_back(value(0.5 * (part.begin + part.end)));
  }
  void learn(std::span<const Interval> run, const Values& found) {
    evaluated += run.size();
    for (const double value : found.at_middle) parts.raise(value);
  }
  void conclude(std::span<const Interval> run, const Values& found) {
    for (std::size_t i = 0; i < run.size(); ++i) {
      const auto& [begin, end, upper] = run[i];
      const double middle = 0.5 * (begin + end), radius = 0.5 * (end - begin);
      const double bound = std::min(upper, found.at_middle[i] + slope() * radius);
      parts.put({begin, middle, bound});
      parts.put({middle, end, bound});
    }
  }
  [[nodiscard]] bool within_budget() const { return evaluated < budget; }

  void run(double precision, const Progress& progress = {}) {
    parts.start(-100, precision);
    parts.put({});
    evaluated = 0;
    branch_and_bound(*this, parts, progress);
  }
};

TEST(BranchAndBound, BoundsContainTheLargestValue) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Waves waves(seed);
    double most = -100;
    for (int i = 0; i <= 100000; ++i) most = std::max(most, waves.value(1e-5 * i));
    for (const double precision : {1.0, 1e-2, 1e-4}) {
      waves.run(precision);
      EXPECT_LE(waves.parts.upper() - waves.parts.lower(), precision);
      EXPECT_GE(waves.parts.upper(), most);
      EXPECT_LE(waves.parts.lower(), most + 1e-5 * waves.slope());
    }
  }
}

TEST(BranchAndBound, DoesNotDependOnTheNumberOfThreads) {
  const auto search = [](unsigned threads) {
    const ThreadLimit limit(threads);
    Waves waves(3);
    waves.run(1e-6);
    return std::array{waves.parts.lower(), waves.parts.upper(), static_cast<double>(waves.evaluated)};
  };
  EXPECT_EQ(search(1), search(4));
}

TEST(BranchAndBound, BoundsHoldWhenTheBudgetIsSpent) {
  Waves waves(5), all(5);
  all.run(1e-6);
  double upper = std::numeric_limits<double>::infinity();
  for (const std::size_t budget : {1, 10, 100, 1000}) {
    waves.budget = budget;
    waves.run(1e-6);
    EXPECT_LE(waves.parts.lower(), all.parts.upper());
    EXPECT_GE(waves.parts.upper(), all.parts.lower());
    EXPECT_LE(waves.parts.upper(), upper);
    upper = waves.parts.upper();
  }
  waves.budget = 0;
  waves.run(1e-6);
  EXPECT_EQ(waves.parts.upper(), std::numeric_limits<double>::infinity());
}

// With a few open parts only.
struct DepthFirst : Waves {
  static constexpr std::size_t kMany = 20, kOfMany = 4;
  using Waves::Waves;
};

TEST(BranchAndBound, DividesPartsWithLowBoundsWhereThereAreMany) {
  Waves waves(6);
  waves.run(1e-3);
  DepthFirst few(6);
  few.parts.start(-100, 1e-3);
  few.parts.put({});
  branch_and_bound(few, few.parts);
  EXPECT_NEAR(few.parts.upper(), waves.parts.upper(), 1e-3);
  EXPECT_LE(few.parts.upper() - few.parts.lower(), 1e-3);
}

TEST(BranchAndBound, ReportsProgressAndIsCancelled) {
  Waves waves(7);
  std::vector<double> done;
  waves.run(1e-6, [&](std::string_view, double fraction) {
    done.push_back(fraction);
    return true;
  });
  ASSERT_GT(done.size(), 5);
  EXPECT_TRUE(std::ranges::is_sorted(done));
  EXPECT_GE(done.front(), 0);
  EXPECT_LE(done.back(), 1);
  EXPECT_THROW(waves.run(1e-6, [](std::string_view, double) { return false; }), Cancelled);
  const std::atomic<bool> cancelled{true};
  const CancelScope scope(cancelled);
  EXPECT_THROW(waves.run(1e-6), Cancelled);
}

}  // namespace
}  // namespace sdm::search
