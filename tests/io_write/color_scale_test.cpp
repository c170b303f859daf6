#include "io/write/pictures/color_scale.h"

#include <gtest/gtest.h>
#include <sdm/error.h>

#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace sdm {
namespace {

using namespace io;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

DistanceMap map_with(std::vector<float> distances, SignMethod sign) {
  DistanceMap map;
  map.distance = std::move(distances);
  map.sign.method = sign;
  return map;
}

TEST(ColorScale, SpansTheUnsignedMapWithViridis) {
  const ColorScale scale = color_scale(map_with({kNaN, 2, 5, 3}, SignMethod::none), {});
  EXPECT_EQ(scale.lo, 2);
  EXPECT_EQ(scale.hi, 5);
  EXPECT_EQ(scale(2), (Rgb{68, 1, 84}));
  EXPECT_EQ(scale(3.5), (Rgb{33, 145, 140}));
  EXPECT_EQ(scale(5), (Rgb{253, 231, 37}));
  EXPECT_EQ(scale(9), scale(5));
  EXPECT_EQ(scale(kNaN), kNoValue);
}

TEST(ColorScale, IsSymmetricAboutZeroForSignedMaps) {
  const ColorScale scale = color_scale(map_with({-1, 4, kNaN}, SignMethod::exact), {});
  EXPECT_EQ(scale.lo, -4);
  EXPECT_EQ(scale.hi, 4);
  EXPECT_EQ(scale(0), (Rgb{255, 255, 255}));
  EXPECT_GT(scale(-1).b, scale(-1).r);
  EXPECT_GT(scale(1).r, scale(1).b);
}

TEST(ColorScale, SpansMapsOfOneSignCompletely) {
  for (const auto& distances : {std::vector<float>{0.5f, 4}, std::vector<float>{-4, -0.5f}}) {
    const ColorScale scale = color_scale(map_with(distances, SignMethod::exact), {});
    EXPECT_EQ(scale.map, Colormap::viridis);
    EXPECT_EQ(scale.lo, distances[0]);
    EXPECT_EQ(scale.hi, distances[1]);
  }
}

TEST(ColorScale, StaysCentredOnZeroInAsymmetricRanges) {
  const ColorScale scale = color_scale(map_with({-1, 2}, SignMethod::exact), {.range = {{-1, 3}}});
  EXPECT_EQ(scale(0), (Rgb{255, 255, 255}));
  EXPECT_EQ(scale(3), (Rgb{103, 0, 31}));
}

TEST(ColorScale, ToleranceBandsChangeExactlyAtTheTolerance) {
  const ColorScale scale = color_scale(map_with({-3, 3}, SignMethod::exact), {.tolerance = 0.5});
  const double above = std::nextafter(0.5, 1);
  EXPECT_EQ(scale(0.5), scale(0));
  EXPECT_EQ(scale(-0.5), scale(0));
  EXPECT_NE(scale(above), scale(0));
  EXPECT_GT(scale(above).r, scale(above).b);
  EXPECT_GT(scale(-above).b, scale(-above).r);
}

TEST(ColorScale, BandsOfATolerancePerSideChangeAtItsLimits) {
  const ColorScale scale =
      color_scale(map_with({-3, 3}, SignMethod::exact), {.tolerance = Tolerance(-0.25, 0.5)});
  EXPECT_EQ(scale(0.5), scale(-0.25));
  EXPECT_GT(scale(std::nextafter(0.5, 1)).r, scale(std::nextafter(0.5, 1)).b);
  EXPECT_GT(scale(std::nextafter(-0.25, -1)).b, scale(std::nextafter(-0.25, -1)).r);
  // A clearance: what is too close is below it.
  const ColorScale clearance =
      color_scale(map_with({0, 3}, SignMethod::none), {.tolerance = Tolerance(1, 2)});
  EXPECT_NE(clearance(0.5), clearance(1.5));
  EXPECT_NE(clearance(0.5), clearance(2.5));
  EXPECT_EQ(clearance(1), clearance(2));
}

TEST(ColorScale, ExplicitColormapOverridesTheBands) {
  const ColorScale scale =
      color_scale(map_with({0, 1}, SignMethod::none), {.colormap = Colormap::paper2006, .tolerance = 0.5});
  EXPECT_EQ(scale(0), (Rgb{255, 0, 0}));
  EXPECT_EQ(scale(1), (Rgb{0, 255, 0}));
}

TEST(ColorScale, HasARangeForMapsWithoutValues) {
  for (const auto& map : {map_with({kNaN}, SignMethod::none), map_with({}, SignMethod::exact),
                          map_with({0, 0}, SignMethod::none), map_with({-2}, SignMethod::exact),
                          map_with({7}, SignMethod::none)})
    for (const std::optional<double> tolerance : {std::optional<double>(), std::optional<double>(0)})
      for (const Colormap colors :
           {Colormap::automatic, Colormap::viridis, Colormap::diverging, Colormap::paper2006}) {
        const ColorScale scale = color_scale(map, {.colormap = colors, .tolerance = tolerance});
        EXPECT_LT(scale.lo, scale.hi);
        EXPECT_TRUE(std::isfinite(scale.lo) && std::isfinite(scale.hi));
      }
}

TEST(ColorScale, RejectsInvalidRangesAndTolerances) {
  const DistanceMap map = map_with({1}, SignMethod::none);
  EXPECT_THROW((void)color_scale(map, {.range = {{1, 1}}}), Error);
  EXPECT_THROW((void)color_scale(map, {.range = {{2, 1}}}), Error);
  EXPECT_THROW((void)color_scale(map, {.range = {{0, kNaN}}}), Error);
  EXPECT_THROW((void)color_scale(map, {.tolerance = -1.0}), Error);
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
