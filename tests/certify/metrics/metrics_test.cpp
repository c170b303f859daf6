// Measures of surfaces: closed forms, random points of the surfaces measured by CGAL, and what users may rely
// on.
#include <sdm/metrics.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/execution.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "certify/metrics/part.h"
#include "support/error_of.h"
#include "support/every_case.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using testing::HasSubstr;

void expect_contains(const BoundedNumber& number, double truth, double slack = 0) {
  EXPECT_LE(number.lower, truth + slack);
  EXPECT_GE(number.upper, truth - slack);
  EXPECT_LE(number.lower, number.value);
  EXPECT_LE(number.value, number.upper);
}

/// Truth from random points: estimates with their standard errors.
struct Sampled {
  std::vector<double> sorted;
  double mean = 0, mean_error = 0, square = 0, square_error = 0;

  Sampled(const Mesh& a, const Mesh& b, std::size_t points, unsigned seed) {
    std::mt19937 random(seed);
    const oracle::CgalDistance distance(b);
    for (const Vec3& p : random_surface_points(a, points, random)) sorted.push_back(distance(p));
    std::ranges::sort(sorted);
    double fourth = 0;
    for (const double d : sorted) {
      mean += d;
      square += d * d;
      fourth += d * d * d * d;
    }
    const auto n = static_cast<double>(points);
    mean /= n;
    square /= n;
    fourth /= n;
    mean_error = std::sqrt(std::max(0.0, square - mean * mean) / n);
    square_error = std::sqrt(std::max(0.0, fourth - square * square) / n);
  }
  [[nodiscard]] double quantile(double fraction) const {
    const auto last = static_cast<double>(sorted.size() - 1);
    return sorted[static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * last)];
  }
  [[nodiscard]] double within(double t) const {
    return static_cast<double>(std::ranges::upper_bound(sorted, t) - sorted.begin()) /
           static_cast<double>(sorted.size());
  }
  /// Of the fractions that quantiles are known for.
  [[nodiscard]] double step() const { return 1 / static_cast<double>(sorted.size()); }
  [[nodiscard]] double fraction_error(double fraction) const {
    return std::sqrt(fraction * (1 - fraction) / static_cast<double>(sorted.size()));
  }
};

constexpr double kErrors = 4;  // standard errors

void expect_agree(const DirectedMetrics& m, const Sampled& truth, const MetricsOptions& options,
                  double size) {
  expect_contains(m.mean, truth.mean, kErrors * truth.mean_error);
  const double square = truth.square, slack = kErrors * truth.square_error;
  EXPECT_LE(m.rms.lower * m.rms.lower, square + slack);
  EXPECT_GE(m.rms.upper * m.rms.upper, square - slack);
  for (std::size_t i = 0; i < options.percentiles.size(); ++i) {
    const double p = options.percentiles[i] / 100, error = kErrors * truth.fraction_error(p) + truth.step();
    EXPECT_LE(m.percentiles[i].lower, truth.quantile(p + error));
    EXPECT_GE(m.percentiles[i].upper, truth.quantile(p - error));
  }
  for (std::size_t i = 0; i < options.tolerances.size(); ++i) {
    const double fraction = truth.within(options.tolerances[i] + MetricsOptions::kRounding * size);
    expect_contains(m.within[i], fraction, kErrors * truth.fraction_error(fraction));
  }
}

// The bounds are as close as was asked for.
void expect_close(const DirectedMetrics& m, const MetricsOptions& options, double size) {
  const auto check = [&](const BoundedNumber& number) {
    using O = MetricsOptions;
    const double usual =
        std::max(O::kRelative * number.lower, std::min(O::kOfNear * number.lower, O::kNear * size));
    const double asked = std::max(options.precision.value_or(usual), O::kLeast * size);
    EXPECT_LE(number.upper - number.lower, asked + 1e-11 * size);
  };
  check(m.mean);
  check(m.rms);
  for (const BoundedNumber& p : m.percentiles) check(p);
  for (const BoundedNumber& f : m.within) EXPECT_LE(f.upper - f.lower, options.fraction_precision + 1e-11);
}

Mesh wavy(int n, double height) {
  Mesh mesh = height_field(n);
  for (Vec3& p : mesh.positions) p[2] *= height;
  return mesh;
}

TEST(LinearOnTriangle, AgreesWithSums) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1, 1);
  constexpr int kSide = 400;
  for (int n = 0; n < 40; ++n) {
    Vec3 at{value(random), value(random), n % 4 == 0 ? 0.0 : value(random)};
    if (n % 5 == 0) at[1] = at[0];
    const metrics::Linear linear(at);
    const double limit = n % 3 == 0 ? at[0] : value(random);
    double mean = 0, square = 0, within = 0, cells = 0;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; i + j < kSide; ++j, ++cells) {
        const double u = (i + 1.0 / 3) / kSide, v = (j + 1.0 / 3) / kSide;
        const double f = at[0] + u * (at[1] - at[0]) + v * (at[2] - at[0]);
        mean += std::max(0.0, f);
        square += std::max(0.0, f) * std::max(0.0, f);
        within += f <= limit ? 1 : 0;
      }
    EXPECT_NEAR(linear.mean(), mean / cells, 0.01);
    EXPECT_NEAR(linear.mean_square(), square / cells, 0.01);
    EXPECT_NEAR(linear.fraction_within(limit), within / cells, 0.01);
  }
  const metrics::Linear constant(Vec3{2, 2, 2});
  EXPECT_EQ(constant.fraction_within(2), 1);
  EXPECT_EQ(constant.fraction_within(1.9), 0);
  EXPECT_EQ(constant.mean(), 2);
  EXPECT_EQ(constant.mean_square(), 4);
}

// At random points of parts, also after divisions and close to the surface.
TEST(MetricParts, BoundTheDistanceOfEachPoint) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const Mesh soups[] = {soup(60, random), degenerate_soup(40, 3), sphere(2), wavy(6, 0.3)};
  for (const Mesh& mesh : soups) {
    const Sites sites(mesh);
    const sites::SitesData& b = internals(sites);
    for (int n = 0; n < 300; ++n) {
      const double size = std::pow(10.0, -3 * unit(random));
      metrics::FacePart part{.face = 0, .area = 1};
      const Vec3 middle = n % 2 == 0 ? random_point({{-1, -1, -1}, {2, 2, 2}}, random)
                                     : random_surface_points(mesh, 1, random)[0];
      const auto measured = [&](const Vec3& p) { return metrics::measure(b, std::array{p}, 1e-6, {})[0]; };
      for (metrics::MeasuredPoint& corner : part.corner)
        corner = measured(middle + size * random_point({{-1, -1, -1}, {1, 1, 1}}, random));
      part.nearest = measured(part.middle()).nearest;
      bound(b, part);
      for (int step = 0; step < 4; ++step) {
        if (step % 2 == 1) bound_thoroughly(b, part);
        for (int k = 0; k < 8; ++k) {
          double s = unit(random), t = unit(random);
          if (s + t > 1) {
            s = 1 - s;
            t = 1 - t;
          }
          const Vec3 weights{1 - s - t, s, t};
          Vec3 p{};
          for (int i = 0; i < 3; ++i) p = p + weights[i] * part.corner[i].at;
          const auto larger = [&](const std::array<Vec3, 2>& functions) {
            return std::max({0.0, dot(weights, functions[0]), dot(weights, functions[1])});
          };
          const double low = larger(part.low), high = larger(part.high);
          const double d = oracle::brute_force(mesh, p);
          EXPECT_LE(low, d + 1e-13);
          EXPECT_GE(high, d - 1e-13);
        }
        const metrics::Cut cut = choose_cut(b, part);
        std::vector<metrics::MeasuredPoint> points;
        const std::array<Vec3, 2> at = cut.of(part);
        for (int k = 0; k < cut.points; ++k) points.push_back(measured(at[k]));
        const std::vector<metrics::FacePart> all = pieces(part, cut, points);
        double area = 0;
        for (const metrics::FacePart& piece : all) area += piece.area;
        EXPECT_NEAR(area, part.area, 1e-15);
        part = all[n % all.size()];
        part.nearest = measured(part.middle()).nearest;
        bound(b, part);
      }
    }
  }
}

/// The surface of a block of 60 × 40 × 20, with n² squares a side, and noise on its vertices.
Mesh measured_block(int n, double noise) {
  Mesh mesh;
  std::mt19937 random(7);
  std::normal_distribution<double> error(0, noise);
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = numbers.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      const Vec3 p{60.0 * at[0] / n, 40.0 * at[1] / n, 20.0 * at[2] / n};
      mesh.positions.push_back(p + Vec3{error(random), error(random), error(random)});
    }
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[(axis + 1) % 3] = i + u;
            at[(axis + 2) % 3] = j + v;
            return vertex(at);
          };
          const std::array<std::uint32_t, 4> quad{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          for (const int k : {1, 2})
            mesh.triangles.push_back(side == n ? Triangle{quad[0], quad[k], quad[k + 1]}
                                               : Triangle{quad[0], quad[k + 1], quad[k]});
        }
  return mesh;
}

// A scan is closer to its part than its faces are large, and crosses it in most of them.
TEST(SurfaceMetrics, OfANoisyScanAreClose) {
  const Mesh scan = measured_block(6, 0.01);
  for (const int n : {1, 6}) {
    SCOPED_TRACE(n);
    const Mesh part = measured_block(n, 0);
    const SurfaceMetrics certified = surface_metrics(scan, part, {.most_parts = 20'000});
    for (const BoundedNumber& number : {certified.percentiles[0], certified.assd, certified.rmsd})
      EXPECT_LE(number.upper - number.lower, 0.03 * number.lower) << number.lower << " " << number.upper;
  }
}

TEST(SurfaceMetrics, OfParallelSquaresAreTheirDistance) {
  const MetricsOptions options{.percentiles = {50, 95}, .tolerances = {0.2, 0.25, 0.3}};
  const SurfaceMetrics m = surface_metrics(square(1, 0), square(1, 0.25), options);
  for (const BoundedNumber& number :
       {m.hausdorff, m.assd, m.masd, m.rmsd, m.percentiles[0], m.percentiles[1]}) {
    expect_contains(number, 0.25);
    EXPECT_LT(number.upper - number.lower, 1e-6);
  }
  expect_contains(m.chamfer_l1, 0.5);
  expect_contains(m.chamfer_l2, 0.125);
  EXPECT_EQ(m.surface_dice[0].upper, 0);
  EXPECT_EQ(m.surface_dice[2].lower, 1);
  EXPECT_EQ(m.f_score[2].certainty, Certainty::exact);
  EXPECT_NEAR(m.normal_consistency, 1, 1e-12);
}

// A unit square turned by 45° about one of its sides: d = x sin 45° = y for points whose foot is on the
// other.
TEST(SurfaceMetrics, OfATiltedSquareAreThoseOfALinearFunction) {
  const Mesh flat = square(18, 0);
  Mesh tilted = square(1, 0);
  for (Vec3& p : tilted.positions) p[2] = 0.75 * (p[0] + 0.5);
  const MetricsOptions options{.percentiles = {10, 50, 95}, .tolerances = {0.3}};
  const DirectedMetrics m = surface_metrics(tilted, flat, options).from[0];
  expect_contains(m.mean, 0.375);
  expect_contains(m.rms, 0.75 / std::sqrt(3));
  expect_contains(m.percentiles[0], 0.075);
  expect_contains(m.percentiles[1], 0.375);
  expect_contains(m.percentiles[2], 0.7125);
  expect_contains(m.within[0], 0.4, 5e-5);  // and what rounding adds to the tolerance
  EXPECT_LT(m.within[0].upper - m.within[0].lower, 1e-5) << "linear: without a division";
  expect_close(m, options, 9 * std::numbers::sqrt2 * 2);
}

TEST(SurfaceMetrics, OfASurfaceAndItselfAreZeroExactly) {
  for (const Mesh& mesh : {sphere(3), torus(24, 12), wavy(12, 0.2)}) {
    const SurfaceMetrics m = surface_metrics(mesh, mesh, {.tolerances = {0, 0.1}});
    for (const BoundedNumber& number :
         {m.hausdorff, m.assd, m.masd, m.rmsd, m.percentiles[0], m.chamfer_l1, m.chamfer_l2}) {
      EXPECT_EQ(number.upper, 0);
      EXPECT_EQ(number.certainty, Certainty::exact);
    }
    EXPECT_EQ(m.surface_dice[0].lower, 1);
    EXPECT_NEAR(m.normal_consistency, 1, 1e-12);
  }
}

struct Pair {
  const char* name;
  Mesh a, b;
};

std::vector<Pair> pairs() {
  const Mesh bunny = placed(load("bunny.obj", "fit"), "fit"), ball = sphere(4);
  std::mt19937 random(5);
  return {{"concentric spheres", ball, placed(sphere(3), "scale:1.1")},
          {"spheres apart", ball, moved(ball, {3, 0, 0})},
          {"crossing tori", torus(48, 24), moved(torus(40, 20), {0.7, 0.2, 0.1})},
          {"waves", wavy(40, 0.1), wavy(31, 0.12)},
          {"soups", soup(200, random), soup(200, random)},
          {"degenerate soups", degenerate_soup(200, 3), degenerate_soup(150, 4)},
          {"a body and its noise", bunny, taken_apart(bunny, 0.002)},
          {"a body turned", bunny, placed(bunny, "rotate:0:0:20")},
          {"a fine and a coarse sphere", sphere(5), sphere(2)},
          {"far from the origin", moved(ball, {1e5, 0, 0}), moved(placed(ball, "scale:1.05"), {1e5, 0, 0})}};
}

// Of each direction as many points as the environment variable SDM_METRICS_POINTS (see tests/long), or these.
TEST(SurfaceMetrics, AgreeWithRandomPointsOfTenPairs) {
  const char* asked = std::getenv("SDM_METRICS_POINTS");
  const std::size_t points = asked != nullptr ? std::stoul(asked) : subset(1000, 4000);
  for (const auto& [name, a, b] : pairs()) {
    SCOPED_TRACE(name);
    const double size = scene_diagonal(a, b);
    const MetricsOptions options{.percentiles = {5, 50, 95, 99},
                                 .tolerances = {0.003 * size, 0.05 * size},
                                 .precision = 1e-3 * size,
                                 .fraction_precision = 5e-3};
    const SurfaceMetrics m = surface_metrics(a, b, options);
    const Sampled from_a(a, b, points, 7), from_b(b, a, points, 8);
    expect_agree(m.from[0], from_a, options, size);
    expect_agree(m.from[1], from_b, options, size);
    for (const DirectedMetrics& d : m.from) expect_close(d, options, size);
    EXPECT_LE(m.percentiles.back().upper, m.hausdorff.upper);
    EXPECT_LE(m.assd.lower, m.rmsd.upper);
    EXPECT_LE(m.rmsd.lower, m.hausdorff.upper);
  }
}

// Closer bounds lie within those before, up to rounding.
TEST(SurfaceMetrics, CloserBoundsAgreeWithWiderOnes) {
  const Mesh a = torus(24, 12), b = moved(torus(20, 10), {0.3, 0.1, 0});
  MetricsOptions options{.tolerances = {0.1}};
  DirectedMetrics before = surface_metrics(a, b, options).from[0];
  for (const double precision : {1e-2, 1e-3, 3e-4}) {
    options.precision = precision;
    options.fraction_precision = precision;
    const DirectedMetrics m = surface_metrics(a, b, options).from[0];
    expect_close(m, options, scene_diagonal(a, b));
    const auto agree = [](const BoundedNumber& x, const BoundedNumber& y) {
      EXPECT_LE(std::max(x.lower, y.lower), std::min(x.upper, y.upper));
    };
    agree(m.mean, before.mean);
    agree(m.rms, before.rms);
    agree(m.percentiles[0], before.percentiles[0]);
    agree(m.within[0], before.within[0]);
    before = m;
  }
}

// Areas of needles are known to a few digits only, and so is what they weigh.
TEST(SurfaceMetrics, HoldForNeedlesWhoseAreasAreInexact) {
  for (const double height : {1e-12, 1e-10, 1e-8}) {
    Mesh needles;
    long double area[2];
    for (std::uint32_t i = 0; i < 2; ++i) {
      const double z = i == 0 ? 0.1 : 1, first = 3.0 * i;
      needles.positions.insert(needles.positions.end(),
                               {{first / 7, 0.1, z},
                                {first / 7 + 1.0 / 3, 0.1 + 0.7 / 3, z},
                                {first / 7 + 0.2 / 3 - height, 0.1 + 0.14 / 3 + (1 + i) * height, z}});
      needles.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      const auto side = [&](std::size_t to, int axis) {
        return static_cast<long double>(needles.positions[3 * i + to][axis]) - needles.positions[3 * i][axis];
      };
      area[i] = std::abs(side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0));
    }
    const auto truth = static_cast<double>((0.1L * area[0] + area[1]) / (area[0] + area[1]));
    expect_contains(surface_metrics(needles, square(40, 0)).from[0].mean, truth);
  }
}

TEST(SurfaceMetrics, SymmetricOnesAreMadeOfBothDirections) {
  const Mesh a = sphere(3), b = moved(torus(16, 8), {0.5, 0, 0});
  const SurfaceMetrics m = surface_metrics(a, b, {.tolerances = {0.5}}),
                       back = surface_metrics(b, a, {.tolerances = {0.5}});
  const auto& [from, to] = m.from;
  const double all = from.area + to.area;
  EXPECT_NEAR(m.assd.value, (from.area * from.mean.value + to.area * to.mean.value) / all, 1e-9);
  EXPECT_NEAR(m.masd.value, (from.mean.value + to.mean.value) / 2, 1e-9);
  EXPECT_NEAR(m.chamfer_l1.value, from.mean.value + to.mean.value, 1e-9);
  for (const auto& [both, one, other] : {std::array{m.percentiles[0], from.percentiles[0], to.percentiles[0]},
                                         std::array{m.hausdorff, from.hausdorff, to.hausdorff},
                                         std::array{back.hausdorff, to.hausdorff, from.hausdorff}}) {
    EXPECT_EQ(both.lower, std::max(one.lower, other.lower));
    EXPECT_EQ(both.upper, std::max(one.upper, other.upper));
  }
  EXPECT_EQ(m.assd.value, back.assd.value);
  EXPECT_EQ(m.surface_dice[0].lower, back.surface_dice[0].lower);
  EXPECT_EQ(m.from[0].mean.value, back.from[1].mean.value);
  const double precision = from.within[0].value, recall = to.within[0].value;
  EXPECT_NEAR(m.f_score[0].value, 2 * precision * recall / (precision + recall), 1e-9);
}

TEST(SurfaceMetrics, AreThoseOfAnyNumberOfThreads) {
  const Mesh a = torus(32, 16), b = moved(sphere(3), {0.3, 0, 0.2});
  const auto numbers = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<double> all;
    const MetricsOptions options{.tolerances = {0.4}};
    for (const NamedMetric& m : named_metrics(surface_metrics(a, b, options), options))
      all.insert(all.end(), {m.number.lower, m.number.value, m.number.upper});
    return all;
  };
  EXPECT_EQ(numbers(1), numbers(4));
}

TEST(SurfaceMetrics, OfEmptySurfacesAreDefined) {
  const MetricsOptions options{.tolerances = {1}};
  const SurfaceMetrics both = surface_metrics({}, {}, options), one = surface_metrics({}, sphere(1), options);
  EXPECT_EQ(both.hausdorff.value, 0);
  EXPECT_EQ(both.assd.value, 0);
  EXPECT_EQ(both.surface_dice[0].value, 1);
  EXPECT_EQ(both.f_score[0].value, 1);
  for (const BoundedNumber& distance :
       {one.hausdorff, one.assd, one.masd, one.rmsd, one.chamfer_l2, one.percentiles[0]})
    EXPECT_TRUE(std::isinf(distance.lower)) << distance.lower;
  EXPECT_EQ(one.surface_dice[0].upper, 0);
  EXPECT_EQ(one.f_score[0].upper, 0);
}

TEST(SurfaceMetrics, NamesAreThoseThatUsersKnow) {
  const MetricsOptions options{.percentiles = {95, 99.5}, .tolerances = {0.25}};
  std::vector<std::string> names;
  for (const NamedMetric& m : named_metrics(surface_metrics(cube(), cube(1.5), options), options))
    names.push_back(m.name);
  EXPECT_EQ(names, (std::vector<std::string>{"hd", "hd95", "hd99.5", "assd", "masd", "rmsd", "chamfer_l1",
                                             "chamfer_l2", "nsd(0.25)", "precision(0.25)", "recall(0.25)",
                                             "f_score(0.25)", "normal_consistency"}));
}

TEST(SurfaceMetrics, RefuseWhatHasNoAnswer) {
  const Mesh ball = sphere(1);
  Mesh segment = single_triangle();
  segment.positions[2] = 0.5 * (segment.positions[0] + segment.positions[1]);
  const auto error = [&](const Mesh& mesh, const MetricsOptions& options) {
    return error_of([&] { (void)surface_metrics(mesh, ball, options); });
  };
  EXPECT_THAT(error(ball, {.percentiles = {100}}), HasSubstr("percentile"));
  EXPECT_THAT(error(ball, {.percentiles = {std::nan("")}}), HasSubstr("percentile"));
  EXPECT_THAT(error(ball, {.tolerances = {-1}}), HasSubstr("tolerance"));
  EXPECT_THAT(error(ball, {.precision = 0}), HasSubstr("precision"));
  EXPECT_THAT(error(segment, {}), HasSubstr("positive area"));
}

TEST(SurfaceMetrics, ReportProgressThatNeverDecreases) {
  const Mesh a = torus(24, 12), b = moved(torus(20, 10), {0.3, 0.1, 0});
  for (MetricsOptions options :
       {MetricsOptions{.precision = 1e-3}, MetricsOptions{.estimate = true, .most_points = 20'000}}) {
    SCOPED_TRACE(options.estimate);
    double last = 0;
    options.progress = [&](std::string_view step, double fraction) {
      EXPECT_EQ(step, "metrics");
      EXPECT_GE(fraction, last);
      last = fraction;
      return true;
    };
    (void)surface_metrics(a, b, options);
    EXPECT_EQ(last, 1);
    // How many reports there are depends on which thread is ready when.
    for (const double at : {0.0, 0.3, 1.0}) {
      options.progress = [&](std::string_view, double fraction) { return fraction < at; };
      EXPECT_THROW((void)surface_metrics(a, b, options), Cancelled) << at;
    }
  }
}

// Where most_parts does not suffice, the bounds are wider, and still bounds.
TEST(SurfaceMetrics, HoldWithFewParts) {
  const Mesh a = cube(), b = moved(torus(30, 20), {0.3, 0, 0});
  const MetricsOptions close{}, few{.most_parts = 10};
  const DirectedMetrics wide = surface_metrics(a, b, few).from[0],
                        narrow = surface_metrics(a, b, close).from[0];
  EXPECT_LE(wide.mean.lower, narrow.mean.lower);
  EXPECT_GE(wide.mean.upper, narrow.mean.upper);
  EXPECT_GT(wide.mean.upper - wide.mean.lower, narrow.mean.upper - narrow.mean.lower);
}

}  // namespace
}  // namespace sdm::test
