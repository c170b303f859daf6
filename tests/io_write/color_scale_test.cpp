#include "io/image/pictures/color_scale.h"

#include <gtest/gtest.h>
#include <sdm/error.h>

#include <algorithm>
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
  result.min = least, result.max = most;
  for (float& d : distances) d = std::abs(d);
  std::ranges::sort(distances);
  const double rank = std::ceil(0.99 * static_cast<double>(distances.size()));
  result.p99_abs = distances[static_cast<std::size_t>(rank) - 1];
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
  const ColorScale scale = scale_of({kNaN, 2, 5, 3});
  EXPECT_EQ(scale.lo, 2);
  EXPECT_EQ(scale.hi, 5);
  EXPECT_EQ(scale(2), (Rgb{68, 1, 84}));
  EXPECT_EQ(scale(3.5), (Rgb{33, 145, 140}));
  EXPECT_EQ(scale(5), (Rgb{253, 231, 37}));
  EXPECT_EQ(scale(9), scale(5));
  EXPECT_EQ(scale(kNaN), kNoValue);
}

TEST(ColorScale, IsSymmetricAboutZeroForSignedMaps) {
  const ColorScale scale = scale_of({-1, 4, kNaN});
  EXPECT_EQ(scale.lo, -4);
  EXPECT_EQ(scale.hi, 4);
  EXPECT_EQ(scale(0), (Rgb{255, 255, 255}));
  EXPECT_GT(scale(-1).b, scale(-1).r);
  EXPECT_GT(scale(1).r, scale(1).b);
}

TEST(ColorScale, SpansMapsOfOneSignCompletely) {
  for (const auto& distances : {std::vector<float>{0.5f, 4}, std::vector<float>{-4, -0.5f}}) {
    const ColorScale scale = scale_of(distances);
    EXPECT_EQ(scale.map, Colormap::viridis);
    EXPECT_EQ(scale.lo, distances[0]);
    EXPECT_EQ(scale.hi, distances[1]);
  }
}

TEST(ColorScale, EndsAtThe99thPercentileOfTheMagnitude) {
  std::vector<float> both = with_outlier(0.5f, -40);
  both[0] = -0.25f;
  EXPECT_EQ(scale_of(both).lo, -0.5);
  EXPECT_EQ(scale_of(both).hi, 0.5);
  std::vector<float> positive = with_outlier(0.5f, 40);
  positive[0] = 0.25f;
  EXPECT_EQ(scale_of(positive).map, Colormap::viridis);
  EXPECT_EQ(scale_of(positive).lo, 0.25);
  EXPECT_EQ(scale_of(positive).hi, 0.5);
  EXPECT_EQ(scale_of(positive, {.range = {{0, 3}}}).hi, 3);
  EXPECT_EQ(scale_of(positive, {.tolerance = 0.1}).hi, 0.5);
  EXPECT_EQ(scale_of(positive, {.tolerance = 2}).hi, 4);
}

TEST(ColorScale, ShowsWhatDiffersWhereNearlyAllIsEqual) {
  EXPECT_EQ(scale_of(with_outlier(0, 3)).hi, 3);
  EXPECT_EQ(scale_of(with_outlier(2, 3)).lo, 2);
  EXPECT_EQ(scale_of(with_outlier(2, 3)).hi, 3);
  // Rounding errors are no values to be told apart.
  EXPECT_EQ(scale_of(with_outlier(1e-7f, -3), {.accuracy = 1e-6}).hi, 3);
}

TEST(ColorScale, FixedOptionsStayAsTheyAre) {
  const DistanceStatistics d = statistics_of(with_outlier(0.5f, -40));
  for (const PictureOptions& options : {PictureOptions{}, PictureOptions{.tolerance = 0.3}}) {
    const PictureOptions once = fixed_colors(options, d), twice = fixed_colors(once, DistanceStatistics{});
    EXPECT_EQ(once.range, twice.range);
    EXPECT_EQ(once.colormap, twice.colormap);
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
  EXPECT_EQ(scale(0.5), scale(0));
  EXPECT_EQ(scale(-0.5), scale(0));
  EXPECT_NE(scale(above), scale(0));
  EXPECT_GT(scale(above).r, scale(above).b);
  EXPECT_GT(scale(-above).b, scale(-above).r);
}

TEST(ColorScale, BandsOfATolerancePerSideChangeAtItsLimits) {
  const ColorScale scale = scale_of({-3, 3}, {.tolerance = Tolerance(-0.25, 0.5)});
  EXPECT_EQ(scale(0.5), scale(-0.25));
  EXPECT_GT(scale(std::nextafter(0.5, 1)).r, scale(std::nextafter(0.5, 1)).b);
  EXPECT_GT(scale(std::nextafter(-0.25, -1)).b, scale(std::nextafter(-0.25, -1)).r);
  // A clearance: what is too close is below it.
  const ColorScale clearance = scale_of({0, 3}, {.tolerance = Tolerance(1, 2)});
  EXPECT_NE(clearance(0.5), clearance(1.5));
  EXPECT_NE(clearance(0.5), clearance(2.5));
  EXPECT_EQ(clearance(1), clearance(2));
}

TEST(ColorScale, ExplicitColormapOverridesTheBands) {
  const ColorScale scale = scale_of({0, 1}, {.colormap = Colormap::paper2006, .tolerance = 0.5});
  EXPECT_EQ(scale(0), (Rgb{255, 0, 0}));
  EXPECT_EQ(scale(1), (Rgb{0, 255, 0}));
}

TEST(ColorScale, HasARangeForMapsWithoutValues) {
  for (const auto& distances : std::vector<std::vector<float>>{{kNaN}, {}, {0, 0}, {-2}, {7}})
    for (const std::optional<double> tolerance : {std::optional<double>(), std::optional<double>(0)})
      for (const Colormap colors :
           {Colormap::automatic, Colormap::viridis, Colormap::diverging, Colormap::paper2006}) {
        const ColorScale scale = scale_of(distances, {.colormap = colors, .tolerance = tolerance});
        EXPECT_LT(scale.lo, scale.hi);
        EXPECT_TRUE(std::isfinite(scale.lo) && std::isfinite(scale.hi));
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
