#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <vector>

#include "io_write/read_png.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Rgb kFirst{0, 114, 178}, kSecond{213, 94, 0};

// The pixels of a colour in rows [top, bottom): their columns and rows.
std::vector<std::array<std::size_t, 2>> of_color(const Pixels& pixels, Rgb color, std::size_t top,
                                                 std::size_t bottom) {
  std::vector<std::array<std::size_t, 2>> found;
  for (std::size_t y = top; y < bottom; ++y)
    for (std::size_t x = 0; x < pixels.width; ++x)
      if (pixels.at(x, y) == color) found.push_back({x, y});
  return found;
}

std::vector<double> numbers(std::size_t count) {
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<double>(i);
  return result;
}

// A line that rises goes from the lower left to the upper right; another panel has its own curves and scale.
TEST(Plot, DrawsCurvesInPanels) {
  const TemporaryFolder folder;
  const std::vector<double> places = numbers(50);
  std::vector<double> falling = places;
  for (double& v : falling) v = -1000 * v;
  const std::vector<PlotPanel> panels{{"rising", {{"", places}}}, {"two", {{"a", falling}, {"b", places}}}};
  write_plot_png(folder / "plot.png", "frame", places, panels);
  const Pixels pixels = read_png(folder / "plot.png");
  const auto upper = of_color(pixels, kFirst, 0, pixels.height / 2 - 20);
  ASSERT_GT(upper.size(), 500u);
  const auto [left, right] = std::ranges::minmax_element(upper);
  EXPECT_GT((*left)[1], (*right)[1] + 100);
  EXPECT_GT((*right)[0], (*left)[0] + pixels.width / 2);
  EXPECT_TRUE(of_color(pixels, kSecond, 0, pixels.height / 2 - 20).empty());
  EXPECT_GT(of_color(pixels, kSecond, pixels.height / 2, pixels.height).size(), 500u);
}

// No line where there is no value; a single value between two gaps is a dot.
TEST(Plot, LeavesGaps) {
  const TemporaryFolder folder;
  std::vector<double> values(101, 1.0);
  values[0] = 0;
  values[100] = 2;
  for (std::size_t i = 40; i <= 60; ++i) values[i] = i == 50 ? 1 : kNaN;
  const std::vector<PlotPanel> panels{{"gap", {{"", values}}}};
  write_plot_png(folder / "plot.png", "frame", numbers(101), panels);
  const Pixels pixels = read_png(folder / "plot.png");
  const auto drawn = of_color(pixels, kFirst, 0, pixels.height);
  const auto between = [&](double a, double b) {
    const double lo = 0.1 * pixels.width + a * 0.873 * pixels.width,
                 hi = 0.1 * pixels.width + b * 0.873 * pixels.width;
    return std::ranges::count_if(drawn,
                                 [&](const auto& p) { return double(p[0]) > lo && double(p[0]) < hi; });
  };
  EXPECT_GT(between(0.1, 0.38), 100);
  EXPECT_EQ(between(0.42, 0.48), 0);
  EXPECT_GT(between(0.48, 0.52), 0);
  EXPECT_EQ(between(0.52, 0.58), 0);
}

TEST(Plot, DrawsAnyValues) {
  const TemporaryFolder folder;
  const auto draw = [&](const std::vector<double>& places, const std::vector<double>& values) {
    const std::vector<PlotPanel> panels{{"title", {{"", values}}}};
    write_plot_png(folder / "plot.png", "frame", places, panels);
    EXPECT_GT(read_png(folder / "plot.png").width, 100u);
  };
  draw({}, {});
  draw({3}, {7});
  draw({0, 1}, {kNaN, kNaN});
  draw({0, 1}, {0, 0});
  draw({0, 1}, {5e300, -5e300});
  draw({0, 1}, {1e-300, 2e-300});
  const std::vector<PlotPanel> wrong{{"title", {{"short", {1, 2}}}}};
  const std::vector<double> places{1, 2, 3};
  EXPECT_THAT([&] { write_plot_png(folder / "wrong.png", "frame", places, wrong); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("'short'")));
  EXPECT_FALSE(std::filesystem::exists(folder / "wrong.png"));
}

}  // namespace
}  // namespace sdm::test
