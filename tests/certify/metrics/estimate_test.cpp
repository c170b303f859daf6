// Estimates of measures from random points: limits of small samples that are tabulated, uniform points, and
// how often intervals contain what is known.
#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/metrics.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "certify/metrics/intervals.h"
#include "certify/metrics/surface_points.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// `measures`: of the pair, computed with bounds that are certain.
void expect_consistent(const SurfaceMetrics& certified, const SurfaceMetrics& estimated,
                       const MetricsOptions& options) {
  const std::vector<NamedMetric> expected = named_metrics(certified, options),
                                 found = named_metrics(estimated, options);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {  // but for normal_consistency
    SCOPED_TRACE(found[i].name);
    EXPECT_EQ(found[i].name, expected[i].name);
    const BoundedNumber &truth = expected[i].number, &number = found[i].number;
    EXPECT_LE(number.lower, truth.upper);
    EXPECT_GE(number.upper, truth.lower);
    EXPECT_LE(number.lower, number.value);
    EXPECT_LE(number.value, number.upper);
    EXPECT_EQ(found[i].confidence.has_value(), number.certainty == Certainty::estimate);
  }
  EXPECT_NE(found.front().number.certainty, Certainty::estimate) << "of the Hausdorff distance";
}

TEST(Binomial, AgreesWithSums) {
  for (const double p : {0.03, 0.4, 0.95}) {
    double sum = 0, term = std::pow(1 - p, 60);
    for (int k = 0; k < 60; ++k) {
      sum += term;
      EXPECT_NEAR(metrics::at_most(60, k, p), sum, 1e-12) << p << " " << k;
      term *= (60.0 - k) / (k + 1) * p / (1 - p);
    }
  }
  EXPECT_EQ(metrics::at_most(60, 60, 0.4), 1);
  EXPECT_EQ(metrics::at_most(5, 2, 0), 1);
  EXPECT_EQ(metrics::at_most(5, 2, 1), 0);
  constexpr std::uint64_t kMany = 4'000'000;  // close to the normal distribution
  const double mean = 0.95 * kMany, deviation = std::sqrt(mean * 0.05);
  for (const double z : {-3.0, -2.0, 1.0}) {
    const auto k = static_cast<std::uint64_t>(mean + z * deviation);
    EXPECT_NEAR(metrics::at_most(kMany, k, 0.95), std::erfc(-z / std::sqrt(2)) / 2, 1e-3) << z;
  }
}

TEST(Binomial, LimitsAreThoseOfTables) {
  EXPECT_EQ(metrics::rank_below(100, 0.5, 0.025), 40);
  EXPECT_EQ(metrics::rank_above(100, 0.5, 0.025), 61);
  EXPECT_EQ(metrics::rank_below(4, 0.5, 0.025), 0);
  EXPECT_EQ(metrics::rank_above(4, 0.5, 0.025), 5);
  EXPECT_NEAR(metrics::most_share(10, 0, 0.025), 0.308498, 1e-6);
  EXPECT_NEAR(metrics::least_share(10, 5, 0.025), 0.187086, 1e-6);
  EXPECT_NEAR(metrics::most_share(10, 5, 0.025), 0.812914, 1e-6);
  EXPECT_EQ(metrics::least_share(10, 0, 0.025), 0);
  EXPECT_EQ(metrics::most_share(10, 10, 0.025), 1);
}

// Shares of parts of faces, with few and with many points a face.
TEST(SurfacePoints, AreUniformByArea) {
  const Mesh mesh{
      {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}, {0, 0, 0.5}, {3, 3, 3}}, {{0, 1, 2}, {3, 0, 0}, {0, 2, 3}}, {}};
  const metrics::SurfacePoints points(mesh);
  EXPECT_DOUBLE_EQ(points.area(), 4.5);
  for (const std::size_t count : {std::size_t{7}, std::size_t{40'000}}) {
    const auto runs = points.runs(count, 3, 1);
    std::vector<metrics::SurfacePoints::Place> run;
    std::map<int, double> parts;  // sixteenths of the first face, and the other one
    std::size_t all = 0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      runs.place(r, run);
      EXPECT_EQ(runs.first(r), all);
      all += run.size();
      for (const auto& [at, face] : run) {
        if (face == 2) {
          ++parts[-1];
          continue;
        }
        ASSERT_EQ(face, 0);
        const double u = at[0], v = 2 * at[1];
        EXPECT_TRUE(u >= 0 && v >= 0 && u + v <= 4 + 1e-12);
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        ++parts[8 * i + 2 * j + (u - i + (v - j) > 1 ? 1 : 0)];
      }
    }
    EXPECT_EQ(all, count);
    if (count < 100) continue;
    EXPECT_EQ(parts.size(), 17);
    for (const auto& [part, found] : parts) {
      const double expected = static_cast<double>(count) * (part == -1 ? 0.5 : 0.25) / 4.5;
      EXPECT_NEAR(found, expected, 4 * std::sqrt(expected)) << part;
    }
  }
}

// How often the intervals of so many seeds contain the measures of a certified result.
std::map<std::string, int> hits(const Mesh& a, const Mesh& b, MetricsOptions options, int seeds) {
  const SurfaceMetrics certified = surface_metrics(a, b, options);
  options.estimate = true;
  std::map<std::string, int> result;
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const SurfaceMetrics estimated = surface_metrics(a, b, options);
    const std::vector<NamedMetric> named = named_metrics(certified, options);
    const std::vector<NamedMetric> found = named_metrics(estimated, options);
    for (std::size_t i = 0; i + 1 < named.size(); ++i)
      result[named[i].name] +=
          found[i].number.lower <= named[i].number.value && named[i].number.value <= found[i].number.upper;
    for (int from = 0; from < 2; ++from) {
      const DirectedMetrics &m = estimated.from[from], &truth = certified.from[from];
      const auto count = [&](const std::string& name, const BoundedNumber& number, double expected) {
        result[name + std::to_string(from)] += number.lower <= expected && expected <= number.upper;
      };
      count("mean", m.mean, truth.mean.value);
      count("rms", m.rms, truth.rms.value);
      for (std::size_t i = 0; i < m.percentiles.size(); ++i)
        count("percentile", m.percentiles[i], truth.percentiles[i].value);
    }
  }
  return result;
}

// Of a square that is tilted above another one: distances from it are uniform between 0 and 0.5, so that
// means and percentiles are known.
TEST(MetricsEstimate, ContainsTheTruthAtLeastAsOftenAsItSays) {
  constexpr int kSeeds = 300, kAtLeast = 291;
  Mesh tilted = square(1, 0);
  for (Vec3& p : tilted.positions) p[2] = p[0] > 0 ? 0.5 : 0;
  MetricsOptions options{
      .percentiles = {95}, .tolerances = {0.2}, .precision = 1e-4, .fraction_precision = 1e-4};
  options.most_points = 1024;
  for (const auto& [name, count] : hits(tilted, square(1, 0), options, kSeeds)) {
    EXPECT_GE(count, kAtLeast) << name;
  }
}

// One face in a hundred thousandth of the area is as far as a thousand times the others: few samples have a
// point of it, and the mean is twice that of the others.
TEST(MetricsEstimate, ContainsTheTruthWhereSamplesMissAFarPart) {
  Mesh a = square(1, 0.001);
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  constexpr double kSide = 0.00447213595499958, kFar = 100;  // of an area of 1e-5
  a.positions.insert(a.positions.end(), {{0, 0, kFar}, {kSide, 0, kFar}, {0, kSide, kFar}});
  a.triangles.push_back({first, first + 1, first + 2});
  const double truth = (0.001 + 1e-5 * kFar) / (1 + 1e-5);
  MetricsOptions options{.estimate = true, .most_points = 1024};
  for (int seed = 0; seed < 20; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const DirectedMetrics m = surface_metrics(a, square(1, 0), options).from[0];
    EXPECT_LE(m.mean.lower, truth);
    EXPECT_GE(m.mean.upper, truth);
    EXPECT_GE(m.rms.upper, std::sqrt(1e-5) * kFar * 0.999);
    EXPECT_GE(m.hausdorff.upper, kFar);
  }
}

TEST(MetricsEstimate, AgreesWithCertifiedBounds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-0.5, 0.5);
  const std::vector<Mesh> meshes{cube(0.8), sphere(2), torus(16, 8), soup(40, random), height_field(6)};
  for (int n = 0; n < 20; ++n) {
    const Mesh& a = meshes[n % 5];
    const Mesh b = moved(meshes[n / 4], {value(random), value(random), value(random)});
    SCOPED_TRACE(n);
    const double size = scene_diagonal(a, b);
    MetricsOptions options{.percentiles = {50, 95},
                           .tolerances = {0.03 * size},
                           .precision = 3e-3 * size,
                           .fraction_precision = 1e-2};
    const SurfaceMetrics certified = surface_metrics(a, b, options);
    options.estimate = true;
    options.most_points = 8192;
    const SurfaceMetrics estimated = surface_metrics(a, b, options);
    expect_consistent(certified, estimated, options);
    EXPECT_EQ(estimated.confidence, 0.99);
    EXPECT_NEAR(estimated.normal_consistency, certified.normal_consistency, 0.05);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(estimated.from[i].area, certified.from[i].area, 1e-9 * certified.from[i].area);
      EXPECT_GE(estimated.from[i].points, 1024);
      EXPECT_LE(estimated.from[i].points, 8192);
    }
  }
}

// With as many points as it needs.
TEST(MetricsEstimate, IsAsCloseAsIsAsked) {
  const Mesh a = torus(24, 12), b = moved(a, {0.02, 0.01, 0});
  const MetricsOptions options{
      .tolerances = {0.01}, .precision = 1e-4, .fraction_precision = 3e-3, .estimate = true};
  const SurfaceMetrics m = surface_metrics(a, b, options);
  for (const BoundedNumber& number : {m.assd, m.masd, m.rmsd, m.percentiles[0]})
    EXPECT_LE(number.upper - number.lower, 2e-4);
  EXPECT_LE(m.surface_dice[0].upper - m.surface_dice[0].lower, 6e-3);
  for (const DirectedMetrics& from : m.from) EXPECT_LT(from.points, options.most_points);
  EXPECT_LE(m.hausdorff.upper, 0.05) << "as large as a tenth of a face";
}

TEST(MetricsEstimate, DependsOnTheSeedAndNotOnThreads) {
  const Mesh a = torus(32, 16), b = moved(sphere(3), {0.3, 0, 0.2});
  const auto numbers = [&](unsigned threads, std::uint64_t seed) {
    const ThreadLimit limit(threads);
    std::vector<double> all;
    const MetricsOptions options{.tolerances = {0.4}, .estimate = true, .most_points = 20'000, .seed = seed};
    for (const NamedMetric& m : named_metrics(surface_metrics(a, b, options), options))
      all.insert(all.end(), {m.number.lower, m.number.value, m.number.upper});
    return all;
  };
  EXPECT_EQ(numbers(1, 0), numbers(4, 0));
  EXPECT_NE(numbers(1, 0), numbers(1, 1));
}

TEST(MetricsEstimate, OfASurfaceAndItselfIsZero) {
  const Mesh mesh = wedge(0.5);
  const MetricsOptions options{.tolerances = {0.1}, .estimate = true, .most_points = 1024};
  const SurfaceMetrics m = surface_metrics(mesh, mesh, options);
  for (const BoundedNumber& number : {m.hausdorff, m.assd, m.rmsd, m.percentiles[0], m.chamfer_l2})
    EXPECT_LE(number.upper, 1e-9);
  EXPECT_EQ(m.surface_dice[0].lower, 1);
  EXPECT_EQ(m.surface_dice[0].certainty, Certainty::exact);
  const SurfaceMetrics none = surface_metrics({}, mesh, options);
  EXPECT_TRUE(std::isinf(none.assd.lower));
  EXPECT_EQ(none.assd.certainty, Certainty::exact);
}

}  // namespace
}  // namespace sdm::test
