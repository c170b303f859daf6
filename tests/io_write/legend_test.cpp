#include "io/image/pictures/legend.h"

#include "io/image/pictures/ticks.h"

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
    EXPECT_EQ(labels.front().value, scale.lo);
    EXPECT_EQ(labels.back().value, scale.hi);
    std::vector<double> limits;
    for (std::size_t k = 0; k < labels.size(); ++k) {
      if (labels[k].is_limit) limits.push_back(labels[k].value);
      if (k == 0) continue;
      EXPECT_LT(labels[k - 1].value, labels[k].value);
      EXPECT_NE(labels[k - 1].text, labels[k].text);
    }
    EXPECT_EQ(limits, (std::vector<double>{tolerance.lo, tolerance.hi}));
  }
  const std::vector<ScaleLabel> labels = scale_labels({.map = Colormap::viridis, .lo = 0, .hi = 0.137});
  EXPECT_EQ(labels.front().text, "0.00");
  EXPECT_EQ(labels.back().text, "0.137");
}

TEST(Legend, ShowsTheColoursFromTopToBottom) {
  const auto close = [](Rgb a, Rgb b) {
    return std::abs(a.r - b.r) < 9 && std::abs(a.g - b.g) < 9 && std::abs(a.b - b.b) < 9;
  };
  const ColorScale scale{.map = Colormap::viridis, .lo = -2, .hi = 5};
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
