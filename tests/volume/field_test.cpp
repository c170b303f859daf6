// Grids, options, reports and errors of distance fields.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include "support/error_of.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Grids, HaveTheCornersOfTheirBox) {
  const Grid grid = make_grid({{-1, 0, 2}, {1, 3, 4}}, {5, 4, 1});
  EXPECT_EQ(grid.spacing, (Vec3{0.5, 1, 2}));
  EXPECT_EQ(grid.point(0, 0, 0), (Vec3{-1, 0, 3}));
  EXPECT_EQ(grid.point(4, 3, 0), (Vec3{1, 3, 3}));
  EXPECT_EQ(grid.size(), 20u);
  EXPECT_EQ(grid.index(4, 3, 0), 19u);
}

TEST(Grids, WithASpacingCoverTheirBox) {
  const Grid grid = make_grid({{0, 0, 0}, {1, 0.95, 0}}, 0.1);
  EXPECT_EQ(grid.dims, (std::array<std::uint32_t, 3>{11, 11, 1})) << "rounding adds no point";
  EXPECT_NEAR(grid.origin[1], -0.025, 1e-12);
  EXPECT_NEAR(grid.point(0, 10, 0)[1], 0.975, 1e-12);
}

TEST(Grids, ThatCannotBeUsedAreErrors) {
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  EXPECT_THAT(error_of([&] { return make_grid(unit, {0, 2, 2}); }), HasSubstr("1 to 1048576 points"));
  EXPECT_THAT(error_of([&] { return make_grid(unit, {2, 2, (1 << 20) + 1}); }), HasSubstr("along z"));
  EXPECT_THAT(error_of([&] { return make_grid({{0, 0, 0}, {1, 0, 1}}, {2, 2, 2}); }), HasSubstr("along y"));
  EXPECT_THAT(error_of([&] {
                return make_grid({{1, 0, 0}, {0, 1, 1}}, {2, 2, 2});
              }),
              HasSubstr("low to high"));
  EXPECT_THAT(error_of([&] { return make_grid({{kNaN, 0, 0}, {1, 1, 1}}, {2, 2, 2}); }), HasSubstr("box"));
  EXPECT_THAT(error_of([&] { return make_grid({{0, 0, 0}, {1, 1, 2e37}}, {2, 2, 2}); }), HasSubstr("1e37"));
  EXPECT_THAT(error_of([&] { return make_grid(unit, 0.0); }), HasSubstr("greater than 0"));
  EXPECT_THAT(error_of([&] { return make_grid(unit, kNaN); }), HasSubstr("greater than 0"));
  EXPECT_THAT(error_of([&] { return make_grid(unit, 1e-9); }), HasSubstr("larger spacing"));
  EXPECT_THAT(error_of([&] {
                return make_grid({{1e9, 0, 0}, {1e9 + 1e-6, 1, 1}}, {100, 2, 2});
              }),
              HasSubstr("told apart"));
}

TEST(Fields, OfWrongOptionsAreErrors) {
  const Sites closed(cube()), open(single_triangle());
  const Grid grid = make_grid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2});
  const auto error = [&](const Sites& sites, const FieldOptions& options) {
    return error_of([&] { return compute_field(sites, grid, options); });
  };
  EXPECT_THAT(error(closed, {.max_distance = 0}), HasSubstr("max_distance is 0"));
  EXPECT_THAT(error(closed, {.max_distance = kNaN}), HasSubstr("max_distance is nan"));
  EXPECT_THAT(error(open, {.sign = SignMethod::exact}), HasSubstr("open"));
  Grid wrong = grid;
  wrong.dims[1] = 0;
  EXPECT_THAT(error_of([&] { return compute_field(closed, wrong); }), HasSubstr("points"));
  wrong = grid;
  wrong.spacing[2] = -1;
  EXPECT_THAT(error_of([&] { return compute_field(closed, wrong); }), HasSubstr("spacing"));
}

TEST(Fields, ThatExceedTheMemoryAreErrors) {
  const Sites sites(cube());
  const std::array<std::uint32_t, 3> most{Grid::kMostPoints, Grid::kMostPoints, Grid::kMostPoints};
  const Grid grid = make_grid({{0, 0, 0}, {1, 1, 1}}, most);
  EXPECT_THAT(error_of([&] { return compute_field(sites, grid); }),
              HasSubstr("a grid of 1048576 × 1048576 × 1048576 points needs 4.61e+09 GB"));
}

TEST(Fields, MayBeFarAway) {
  const Sites sites(cube());
  const Grid grid = make_grid({{1e20, 0, 0}, {2e20, 1e20, 1e20}}, {2, 2, 2});
  EXPECT_NEAR(compute_field(sites, grid).distance[0], 1e20, 1e14);
}

TEST(Fields, CanBeCancelled) {
  const Sites sites(sphere(2));
  const Grid grid = make_grid({{-1, -1, -1}, {1, 1, 1}}, {24, 24, 24});
  FieldOptions options{.max_distance = 1};
  std::vector<double> seen;
  options.progress = [&](std::string_view, double fraction) {
    seen.push_back(fraction);
    return true;
  };
  (void)compute_field(sites, grid, options);
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back(), 1);
  EXPECT_GE(*std::ranges::min_element(seen), 0);
  EXPECT_LE(*std::ranges::max_element(seen), 1);
  options.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)compute_field(sites, grid, options), Cancelled);
}

TEST(Fields, ReportTheirMemory) {
  const FieldScene scene = field_scenes()[0];
  FieldReport report;
  (void)compute_field(Sites(scene.mesh), scene.grid, {}, report);
  EXPECT_EQ(report.field_bytes, 4 * scene.grid.size());
  EXPECT_GT(report.working_bytes, 0u);
}

TEST(Fields, HaveNoValueBeyondTheMaximumDistance) {
  const Grid grid = make_grid({{-2, -2, -2}, {2, 2, 2}}, {9, 9, 9});
  const DistanceField field = compute_field(Sites(cube()), grid, {.max_distance = 0.5});
  std::size_t without = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    without += std::isnan(field.distance[i]);
    if (!std::isnan(field.distance[i])) {
      EXPECT_LE(std::abs(field.distance[i]), 0.5f);
    }
  }
  EXPECT_EQ(field.beyond_max_distance, without);
  EXPECT_GT(without, 0u);
  EXPECT_TRUE(std::isnan(field.distance[grid.index(4, 4, 4)]));
  EXPECT_EQ(field.distance[grid.index(4, 4, 3)], -0.5f) << "at the band exactly";
  EXPECT_EQ(compute_field(Sites(cube()), grid, {.max_distance = kInfinity}).beyond_max_distance, 0u);
}

}  // namespace
}  // namespace sdm::test
