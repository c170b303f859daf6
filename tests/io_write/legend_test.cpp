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
