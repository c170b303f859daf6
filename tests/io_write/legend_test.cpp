#include "io/image/pictures/legend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>

#include <cmath>
#include <random>

namespace sdm {
namespace {

using namespace io;

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-12, 12), offset(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10, exponent(random)), lo = offset(random) * size, hi = lo + size;
    const auto values = ticks(lo, hi, 10);
    ASSERT_GE(values.size(), 4u);
    ASSERT_LE(values.size(), 11u);
    const double step = values[1] - values[0];
    const double mantissa = step / std::pow(10, std::floor(std::log10(step) + 1e-9));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 ||
                std::abs(mantissa - 5) < 1e-6)
        << step;
    for (std::size_t k = 0; k < values.size(); ++k) {
      EXPECT_GE(values[k], lo - 1e-6 * size);
      EXPECT_LE(values[k], hi + 1e-6 * size);
      EXPECT_NEAR(values[k] / step, std::round(values[k] / step), 1e-6);
    }
  }
}

TEST(Legend, NamesTheEndsAndTheLimits) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-9, 9), part(0.1, 1);
  for (int i = 0; i < 500; ++i) {
    const double size = std::pow(10, exponent(random)), reach = size * part(random);
    const Tolerance tolerance(-0.4 * reach * part(random), 0.4 * reach * part(random));
    const DistanceStatistics d{
        .texels = 9, .min = -reach, .max = reach, .p05 = -1, .p95 = 1, .p99_abs = reach};
    const ColorScale scale = color_scale(fixed_colors({.tolerance = tolerance}, d));
    const std::vector<ScaleLabel> labels = scale_labels(scale);
    ASSERT_GE(labels.size(), 5u);
    ASSERT_LE(labels.size(), 13u);
    EXPECT_EQ(labels.front().value, scale.lower);
    EXPECT_EQ(labels.back().value, scale.upper);
    std::vector<double> limits;
    for (std::size_t k = 0; k < labels.size(); ++k) {
      if (labels[k].is_limit) limits.push_back(labels[k].value);
      if (k == 0) continue;
      EXPECT_LT(labels[k - 1].value, labels[k].value);
      EXPECT_NE(labels[k - 1].text, labels[k].text);
    }
    EXPECT_EQ(limits, (std::vector<double>{tolerance.lower, tolerance.upper}));
  }
  const std::vector<ScaleLabel> labels = scale_labels({.map = Colormap::viridis, .lower = 0, .upper = 0.137});
  EXPECT_EQ(labels.front().text, "0.00");
  EXPECT_EQ(labels.back().text, "0.137");
}

// What has no limit on a side names none there, and darkens towards the other one only.
TEST(Legend, NamesTheOnlyLimit) {
  const DistanceStatistics d{.texels = 9, .min = 0.05, .max = 0.73, .p05 = 0.1, .p95 = 0.7, .p99_abs = 0.73};
  DistanceMap map;
  map.measured.kind = DistanceKind::thickness;
  const auto scale_of = [&](const Tolerance& tolerance) {
    return color_scale(fixed_colors({.tolerance = tolerance}, d));
  };
  const ColorScale least = scale_of({0.1, kInfinity}), most = scale_of({-kInfinity, 0.4});
  const LegendText of_least = legend_text(map, 0.05, 0.73, least, "mm"),
                   of_most = legend_text(map, 0.05, 0.73, most, "mm");
  EXPECT_EQ(of_least.title, "Thickness");
  EXPECT_THAT(of_least.notes, ::testing::IsSupersetOf({"green: at least 0.1", "darker: nearer the limit"}));
  EXPECT_THAT(of_most.notes, ::testing::Contains("green: at most 0.4"));
  EXPECT_THAT(of_least.notes, ::testing::Not(::testing::Contains("unsigned")));
  EXPECT_THAT(legend_text({}, 0, 1, scale_of({-0.4, 0.4}), "").notes,
              ::testing::IsSupersetOf({"green: within 0.4", "darker: nearer a limit", "unsigned"}));
  map.measured.kind = DistanceKind::closest;
  map.sign.method = SignMethod::exact;
  EXPECT_THAT(legend_text(map, -1, 1, scale_of({-0.4, 0.4}), "").notes,
              ::testing::Contains("green: within \u00b10.4"));
  for (const ColorScale* scale : {&least, &most}) {
    std::vector<double> limits;
    for (const ScaleLabel& label : scale_labels(*scale))
      if (label.is_limit) limits.push_back(label.value);
    EXPECT_EQ(limits, std::vector{scale == &least ? 0.1 : 0.4});
  }
  EXPECT_EQ(least.upper, 0.8);
  EXPECT_EQ(least(0.1), kWithin.back());
  EXPECT_EQ(least(0.8), kWithin.front());
  EXPECT_EQ(least(5), kWithin.front());
  EXPECT_EQ(most(0.4), kWithin.back());
  EXPECT_EQ(most(0.01), kWithin.front());
  for (int i = 11; i < 80; ++i) EXPECT_GE(least(0.01 * i + 0.01).g, least(0.01 * i).g) << i;
  for (int i = 1; i < 39; ++i) EXPECT_LE(most(0.01 * i + 0.01).g, most(0.01 * i).g) << i;
  EXPECT_THROW(scale_of({-kInfinity, kInfinity}), Error);
}

TEST(Legend, ShowsTheColoursFromTopToBottom) {
  const auto close = [](Rgb a, Rgb b) {
    return std::abs(a.r - b.r) < 9 && std::abs(a.g - b.g) < 9 && std::abs(a.b - b.b) < 9;
  };
  const ColorScale scale{.map = Colormap::viridis, .lower = -2, .upper = 5};
  for (const std::uint32_t resolution : {16u, 1024u, 8192u}) {
    const Picture legend = draw_legend(scale, {"Distance", "mm", {"note"}, true}, resolution);
    ASSERT_EQ(legend.pixels.size(), std::size_t{legend.width} * legend.height);
    // Down the middle of the bar: the last pixel of the first colour, the first one of the last.
    const std::size_t x = legend.width * 39 / 232;
    std::size_t top = legend.height, bottom = 0;
    for (std::size_t y = 0; y < legend.height; ++y) {
      if (close(legend.pixels[y * legend.width + x], scale(5))) top = std::min(top, y);
      if (close(legend.pixels[y * legend.width + x], scale(-2))) bottom = std::max(bottom, y);
    }
    EXPECT_LT(top, legend.height / 4);
    EXPECT_GT(bottom, legend.height / 2);
    EXPECT_LT(bottom, legend.height);
  }
}

TEST(Legend, RejectsInvalidText) {
  EXPECT_THROW((void)draw_legend({}, {"Distance", "\xff\xfe", {}, false}, 64), Error);
}

}  // namespace
}  // namespace sdm
