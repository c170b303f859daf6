#include "io/image/pictures/color_scale.h"

#include <gtest/gtest.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace sdm {
namespace {

using namespace io;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The statistics of values with equal areas, as far as a colour scale depends on them.
DistanceStatistics statistics_of(std::vector<float> distances) {
  std::erase_if(distances, [](float d) { return std::isnan(d); });
  DistanceStatistics result{.texels = distances.size()};
  if (distances.empty()) return result;
  const auto [least, most] = std::ranges::minmax(distances);
  result.min = least;
  result.max = most;
  std::ranges::sort(distances);
  const auto percentile = [&](double share) {
    const double rank = std::ceil(share * static_cast<double>(distances.size()));
    return distances[static_cast<std::size_t>(rank) - 1];
  };
  result.p05 = percentile(0.05);
  result.p95 = percentile(0.95);
  for (float& d : distances) d = std::abs(d);
  std::ranges::sort(distances);
  result.p99_abs = percentile(0.99);
  return result;
}

ColorScale scale_of(const std::vector<float>& distances, const PictureOptions& options = {}) {
  return color_scale(fixed_colors(options, statistics_of(distances)));
}

/// `value` at each of 99 places and `outlier` at one.
std::vector<float> with_outlier(float value, float outlier) {
  std::vector<float> distances(99, value);
  distances.push_back(outlier);
  return distances;
}

TEST(ColorScale, SpansTheUnsignedMapWithViridis) {
  const ColorScale scale = scale_of({kNaN, 3, 5, 4});
  EXPECT_EQ(scale.lower, 3);
  EXPECT_EQ(scale.upper, 5);
  EXPECT_EQ(scale(3), (Rgb{68, 1, 84}));
  EXPECT_EQ(scale(4), (Rgb{33, 145, 140}));
  EXPECT_EQ(scale(5), (Rgb{253, 231, 37}));
  EXPECT_EQ(scale(9), scale(5));
  EXPECT_EQ(scale(kNaN), kNoValue);
}

TEST(ColorScale, IsSymmetricAboutZeroForSignedMaps) {
  const ColorScale scale = scale_of({-1, 4, kNaN});
  EXPECT_EQ(scale.lower, -4);
  EXPECT_EQ(scale.upper, 4);
  EXPECT_EQ(scale(0), (Rgb{255, 255, 255}));
  EXPECT_GT(scale(-1).b, scale(-1).r);
  EXPECT_GT(scale(1).r, scale(1).b);
}

TEST(ColorScale, BeginsAtZeroForMapsOfOneSign) {
  const ColorScale above = scale_of({0.5f, 4}), below = scale_of({-4, -0.5f});
  EXPECT_EQ(above.map, Colormap::viridis);
  EXPECT_EQ(below.map, Colormap::sequential);
  EXPECT_EQ(std::pair(above.lower, above.upper), std::pair(0.0, 4.0));
  EXPECT_EQ(std::pair(below.lower, below.upper), std::pair(-4.0, 0.0));
  for (const double d : {0.0, 0.5, 3.0, 4.0, 5.0}) EXPECT_EQ(above(d), below(-d)) << d;
}

/// `value` at each of 100 − `count` places and `other` at the rest.
std::vector<float> with_others(float value, float other, std::size_t count) {
  std::vector<float> distances(100 - count, value);
  distances.insert(distances.end(), count, other);
  return distances;
}

// Less than 5 % of the area on one side of 0: the other one has the whole of viridis.
TEST(ColorScale, IsSequentialIfOneSideHasLittleOfTheArea) {
  for (const float sign : {1.0f, -1.0f}) {
    const ColorScale scale = scale_of(with_others(4 * sign, -1 * sign, 4));
    EXPECT_EQ(scale.map, Colormap::sequential);
    EXPECT_EQ(scale.lower, sign > 0 ? -1 : -4);
    EXPECT_EQ(scale.upper, sign > 0 ? 4 : 1);
    EXPECT_EQ(scale(0), (Rgb{68, 1, 84}));
    EXPECT_EQ(scale(4 * sign), (Rgb{253, 231, 37}));
    for (const double d : {0.001, 0.2, 1.0, 9.0}) {
      const Rgb c = scale(-d * sign);
      EXPECT_GT(c.r, 100 + std::max(c.g, c.b)) << "red: " << d;
    }
    EXPECT_EQ(scale_of(with_others(4 * sign, -1 * sign, 6)).map, Colormap::diverging);
    // Nearly white, if it were diverging.
    EXPECT_EQ(scale_of(with_others(4 * sign, -0.3f * sign, 30)).map, Colormap::sequential);
  }
  // As far as it is deep, but half of the other side at most.
  EXPECT_EQ(scale_of(with_others(4, -40, 2)).lower, -2);
  EXPECT_EQ(scale_of(with_others(4, -40, 2)).upper, 4);
  // Rounding is no other side.
  const ColorScale rounding = scale_of(with_others(4, -1e-7f, 40), {.accuracy = 1e-6});
  EXPECT_EQ(rounding.map, Colormap::viridis);
  EXPECT_EQ(rounding.lower, 0);
  const ColorScale few = scale_of(with_others(4, -1, 4), {.accuracy = 1e-3});
  EXPECT_EQ(few(-5e-4), few(0));
}

// Nothing that is red could be a distance of the longer side.
TEST(ColorScale, TheShorterSideHasColoursOfItsOwn) {
  const ColorScale scale{.map = Colormap::sequential, .lower = -1, .upper = 2};
  for (int i = 0; i <= 100; ++i)
    for (int k = 1; k <= 100; ++k) {
      const Rgb a = scale(0.02 * i), b = scale(-0.01 * k);
      ASSERT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 60) << i << ' ' << k;
    }
}

TEST(ColorScale, EndsAreRound) {
  const auto range = [](const ColorScale& scale) { return std::pair(scale.lower, scale.upper); };
  EXPECT_EQ(range(scale_of({0.0137f, 0.001f})), std::pair(0.0, 0.014));
  EXPECT_EQ(range(scale_of({-0.0137f, 0.01f})), std::pair(-0.015, 0.015));
  EXPECT_EQ(range(scale_of({0, 0.29f})), std::pair(0.0, 0.3));
  EXPECT_EQ(range(scale_of({0, 123456})), std::pair(0.0, 140000.0));
  EXPECT_EQ(range(scale_of({-3, 2}, {.tolerance = Tolerance(-0.05, 0.01)})), std::pair(-3.0, 2.0));
  EXPECT_EQ(range(scale_of({-0.01f, 0.01f}, {.tolerance = Tolerance(-0.05, 0.01)})), std::pair(-0.1, 0.06));
  for (const float d : {1e-38f, 1e-20f, 1e20f, 3e38f}) {
    const ColorScale scale = scale_of({0, d});
    EXPECT_GE(scale.upper, d);
    EXPECT_LE(scale.upper, 1.5 * d);
  }
}

TEST(ColorScale, OfSeveralMapsIsSequentialOnlyIfOneSideIsShort) {
  const ColorRange above{.colormap = Colormap::sequential, .range = {-1, 4}};
  const ColorRange below{.colormap = Colormap::sequential, .range = {-4, 1}};
  const ColorRange one{.colormap = Colormap::viridis, .range = {2, 6}};
  EXPECT_EQ(widest(above, one).colormap, Colormap::sequential);
  EXPECT_EQ(widest(one, above).range, (std::array<double, 2>{-1, 6}));
  EXPECT_EQ(widest(above, below).colormap, Colormap::diverging);
  EXPECT_EQ(widest(above, below).range, (std::array<double, 2>{-4, 4}));
  const ColorRange both{.colormap = Colormap::diverging, .range = {-1, 1}};
  EXPECT_EQ(widest(both, one).colormap, Colormap::sequential);
  EXPECT_EQ(widest(one, both).range, (std::array<double, 2>{-1, 6}));
  EXPECT_EQ(widest(both, both).colormap, Colormap::diverging);
}

TEST(ColorScale, EndsAtThe99thPercentileOfTheMagnitude) {
  std::vector<float> both = with_outlier(0.5f, -40);
  both[0] = -0.25f;
  EXPECT_EQ(scale_of(both).lower, -0.3);  // rounded
  EXPECT_EQ(scale_of(both).upper, 0.5);
  std::fill_n(both.begin(), 10, -0.25f);
  EXPECT_EQ(scale_of(both).map, Colormap::diverging);
  EXPECT_EQ(scale_of(both).lower, -0.5);
  EXPECT_EQ(scale_of(both).upper, 0.5);
  std::vector<float> positive = with_outlier(0.5f, 40);
  positive[0] = 0.25f;
  EXPECT_EQ(scale_of(positive).map, Colormap::viridis);
  EXPECT_EQ(scale_of(positive).lower, 0.25);
  EXPECT_EQ(scale_of(positive).upper, 0.5);
  EXPECT_EQ(scale_of(positive, {.range = {{0, 3}}}).upper, 3);
  EXPECT_EQ(scale_of(positive, {.tolerance = 0.1}).upper, 0.5);
  EXPECT_EQ(scale_of(positive, {.tolerance = 2}).upper, 4);
}

TEST(ColorScale, ShowsWhatDiffersWhereNearlyAllIsEqual) {
  EXPECT_EQ(scale_of(with_outlier(0, 3)).upper, 3);
  EXPECT_EQ(scale_of(with_outlier(2, 3)).lower, 2);
  EXPECT_EQ(scale_of(with_outlier(2, 3)).upper, 3);
  // Rounding errors are no values to be told apart.
  EXPECT_EQ(scale_of(with_outlier(1e-7f, -3), {.accuracy = 1e-6}).lower, -3);
  EXPECT_EQ(scale_of(with_outlier(1e-7f, -3), {.accuracy = 1e-6}).upper, 0);
}

TEST(ColorScale, FixedOptionsStayAsTheyAre) {
  const DistanceStatistics d = statistics_of(with_outlier(0.5f, -40));
  for (const PictureOptions& options : {PictureOptions{}, PictureOptions{.tolerance = 0.3}}) {
    const PictureOptions once = fixed_colors(options, d), twice = fixed_colors(once, DistanceStatistics{});
    EXPECT_EQ(once.range, twice.range);
    EXPECT_EQ(once.colormap, twice.colormap);
  }
}

TEST(ColorScale, IsThatOfSingleColours) {
  for (const PictureOptions& options : {PictureOptions{}, PictureOptions{.tolerance = 0.3}}) {
    const PictureOptions fixed = fixed_colors(options, statistics_of({-1, 0.2f, 0.5f, 2}));
    const ColorScale scale = color_scale(fixed);
    for (const double d : {-3.0, -0.5, 0.0, 0.25, 1.9, std::numeric_limits<double>::quiet_NaN()}) {
      const Rgb expected = scale(d);
      EXPECT_EQ(color_of(fixed, d), (std::array{expected.r, expected.g, expected.b})) << d;
    }
  }
}

TEST(ColorScale, StaysCentredOnZeroInAsymmetricRanges) {
  const ColorScale scale = scale_of({-1, 2}, {.range = {{-1, 3}}});
  EXPECT_EQ(scale(0), (Rgb{255, 255, 255}));
  EXPECT_EQ(scale(3), (Rgb{103, 0, 31}));
}

TEST(ColorScale, ToleranceBandsChangeExactlyAtTheTolerance) {
  const ColorScale scale = scale_of({-3, 3}, {.tolerance = 0.5});
  const double above = std::nextafter(0.5, 1);
  EXPECT_EQ(scale(0.5), scale(0.4));
  EXPECT_EQ(scale(-0.5), scale(0.5));
  EXPECT_NE(scale(above), scale(0.5));
  EXPECT_GT(scale(above).r, scale(above).b);
  EXPECT_GT(scale(-above).b, scale(-above).r);
}

TEST(ColorScale, BandsOfATolerancePerSideChangeAtItsLimits) {
  const ColorScale scale = scale_of({-3, 3}, {.tolerance = Tolerance(-0.25, 0.5)});
  EXPECT_EQ(scale(0.5), scale(-0.25));
  EXPECT_EQ(scale(0.2), scale(-0.1)) << "as close to the limit of its side";
  EXPECT_GT(scale(std::nextafter(0.5, 1)).r, scale(std::nextafter(0.5, 1)).b);
  EXPECT_GT(scale(std::nextafter(-0.25, -1)).b, scale(std::nextafter(-0.25, -1)).r);
  // A clearance: what is too close is below it.
  const ColorScale clearance = scale_of({0, 3}, {.tolerance = Tolerance(1, 2)});
  EXPECT_NE(clearance(0.5), clearance(1.5));
  EXPECT_NE(clearance(0.5), clearance(2.5));
  EXPECT_EQ(clearance(1), clearance(2));
}

// Darker from quarter to quarter.
TEST(ColorScale, StepsWithinTheToleranceTellHowCloseItIs) {
  const auto light = [](Rgb c) { return 0.21 * c.r + 0.72 * c.g + 0.07 * c.b; };
  const ColorScale scale = scale_of({-3, 3}, {.tolerance = 0.4});
  const ColorScale clearance = scale_of({0, 3}, {.tolerance = Tolerance(1, 1.8)});
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double from = 0.1 * quarter;
    EXPECT_EQ(scale(from + 0.01), scale(from + 0.09));
    EXPECT_EQ(scale(from + 0.01), scale(-from - 0.09));
    EXPECT_EQ(clearance(1.4 + from + 0.01), scale(from + 0.01));
    EXPECT_EQ(clearance(1.4 - from - 0.01), scale(from + 0.01));
    if (quarter > 0) {
      EXPECT_LT(light(scale(from + 0.01)), light(scale(from - 0.01)) - 20);
    }
  }
  // No upper limit, but that of the scale.
  const ColorScale wall{.lower = 0, .upper = 3, .tolerance = Tolerance(1, 100)};
  EXPECT_EQ(wall(1.01), scale(0.4));
  EXPECT_EQ(wall(50), scale(0));
}

TEST(ColorScale, ExplicitColormapOverridesTheBands) {
  const ColorScale scale = scale_of({0, 1}, {.colormap = Colormap::paper2006, .tolerance = 0.5});
  EXPECT_EQ(scale(0), (Rgb{255, 0, 0}));
  EXPECT_EQ(scale(1), (Rgb{0, 255, 0}));
}

TEST(ColorScale, HasARangeForMapsWithoutValues) {
  for (const auto& distances : std::vector<std::vector<float>>{{kNaN}, {}, {0, 0}, {-2}, {7}})
    for (const std::optional<double> tolerance : {std::optional<double>(), std::optional<double>(0)})
      for (const Colormap colors : {Colormap::automatic, Colormap::viridis, Colormap::sequential,
                                    Colormap::diverging, Colormap::paper2006}) {
        const ColorScale scale = scale_of(distances, {.colormap = colors, .tolerance = tolerance});
        EXPECT_LT(scale.lower, scale.upper);
        EXPECT_TRUE(std::isfinite(scale.lower) && std::isfinite(scale.upper));
      }
}

TEST(ColorScale, RejectsInvalidRangesAndTolerances) {
  EXPECT_THROW((void)scale_of({1}, {.range = {{1, 1}}}), Error);
  EXPECT_THROW((void)scale_of({1}, {.range = {{2, 1}}}), Error);
  EXPECT_THROW((void)scale_of({1}, {.range = {{0, kNaN}}}), Error);
  EXPECT_THROW((void)scale_of({1}, {.tolerance = -1.0}), Error);
}

// Adjacent sites often have close numbers.
TEST(SiteColor, DiffersBetweenCloseNumbers) {
  for (const SiteType type : {SiteType::vertex, SiteType::edge, SiteType::face}) {
    std::set<std::tuple<int, int, int>> colors;
    for (std::uint32_t site = 0; site < 256; ++site) {
      const Rgb c = site_color(type, site);
      colors.insert({c.r / 4, c.g / 4, c.b / 4});
    }
    EXPECT_GT(colors.size(), 200u);
  }
}

}  // namespace
}  // namespace sdm
