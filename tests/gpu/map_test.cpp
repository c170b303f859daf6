// Maps that stay on a device: their statistics are those of their distances, also of several parts.
#include <gmock/gmock.h>
#include <sdm/gpu.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "support/error_of.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;

std::vector<double> expected_distances(const Surface& surface, const Sites& sites) {
  std::vector<double> distances;
  for (const ClosestPoint& closest : closest_points(sites, surface.sample_points(), {}))
    distances.push_back(closest.distance);
  return distances;
}

// Within their errors; and what is summed up on the device is what was read back.
void expect_map(const GpuMap& map, const std::vector<double>& expected) {
  const std::vector<float> found = map.distances();
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_EQ(map.samples(), expected.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_NEAR(found[i], expected[i], map.error(found[i])) << i;
    sum += expected[i];
    squares += expected[i] * expected[i];
  }
  std::vector<double> sorted = expected;
  std::ranges::sort(sorted);
  const auto count = static_cast<double>(expected.size());
  for (const double tolerance : {0.0, sorted[sorted.size() / 3], 2 * sorted.back()}) {
    const GpuMapStatistics all = map.statistics(tolerance);
    EXPECT_EQ(all.samples, expected.size());
    EXPECT_EQ(all.smallest, *std::ranges::min_element(found));
    EXPECT_EQ(all.largest, *std::ranges::max_element(found));
    EXPECT_EQ(all.largest_at, static_cast<std::uint64_t>(std::ranges::max_element(found) - found.begin()));
    EXPECT_NEAR(all.mean, sum / count, all.error);
    EXPECT_NEAR(all.rms, std::sqrt(squares / count), all.error);
    EXPECT_LE(all.error, 1e-4 * sorted.back());
    const auto within = [&](double limit) {
      return static_cast<std::uint64_t>(std::ranges::upper_bound(sorted, limit) - sorted.begin());
    };
    // Certain are all but those whose error contains the tolerance, which are as many as that, at most.
    EXPECT_LE(all.within, within(tolerance));
    EXPECT_LE(all.beyond, expected.size() - within(tolerance));
    EXPECT_GE(all.within, within(tolerance - 2 * map.error(tolerance)));
    EXPECT_GE(all.beyond, expected.size() - within(tolerance + 2 * map.error(tolerance)));
  }
}

TEST(GpuMap, StatisticsAreThoseOfTheDistances) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 256});
  const Sites apart(test::load("head.off", "fit,translate:0.9:0:0")), mixed(test::load("head.off", "fit"));
  GpuMap map(surface, apart);
  expect_map(map, expected_distances(surface, apart));
  map.compute(surface, mixed);
  expect_map(map, expected_distances(surface, mixed));
}

// More samples than a part has, and then fewer.
TEST(GpuMap, SeveralParts) {
  const Surface large(test::load("head.off", "fit"), {.resolution = 1500}),
      small(test::load("head.off", "fit"), {.resolution = 100});
  ASSERT_GT(large.sample_texels().size(), 1u << 20);
  const Sites sites(test::torus(16, 16));
  GpuMap map(large, sites);
  expect_map(map, expected_distances(large, sites));
  map.compute(small, sites);
  expect_map(map, expected_distances(small, sites));
}

TEST(GpuMap, FollowsFrames) {
  Mesh o1 = test::load("cow.off", "fit"), o2 = test::load("head.off", "fit,translate:0.5:0:0");
  Surface surface(o1, {.resolution = 128});
  Sites sites(o2);
  GpuMap map(surface, sites);
  for (int frame = 0; frame < 6; ++frame) {
    for (Vec3& p : o1.positions) p = p + Vec3{0.05, 0, 0};
    for (Vec3& p : o2.positions) p = 1.3 * p;
    sites.refit(o2.positions);
    map.compute(o1.positions, sites);
    surface.refit(o1.positions);
    expect_map(map, expected_distances(surface, sites));
  }
}

// More faces at the same distance than a list has room for.
TEST(GpuMap, PointsWithIncompleteLists) {
  const Sites fan(test::fan(60));
  const Surface surface(test::sphere(2), {.resolution = 128});
  const auto engine = make_gpu_engine({});
  (void)compute_map(surface, fan, {.engine = engine});
  EXPECT_GT(gpu_report(*engine)->incomplete, 0u);
  const GpuMap map(surface, fan);
  expect_map(map, expected_distances(surface, fan));
}

TEST(GpuMap, WhatItRefuses) {
  const Surface surface(test::cube(1), {.resolution = 32});
  const Sites near(test::cube(1.5)), small(test::cube(0.01));
  GpuMap map(surface, near);
  EXPECT_THAT(test::error_of([&] { return map.statistics(-1); }), HasSubstr("not negative"));
  EXPECT_THAT(test::error_of([&] { return map.statistics(std::numeric_limits<double>::quiet_NaN()); }),
              HasSubstr("not negative"));
  EXPECT_EQ(map.statistics(std::numeric_limits<double>::infinity()).within, map.samples());
  EXPECT_THAT(test::error_of([&] { map.compute(surface, small); }), HasSubstr("too far from O2"));
  EXPECT_EQ(map.samples(), 0u);
  EXPECT_THAT(test::error_of([&] { return map.distances(); }), HasSubstr("no map"));
  map.compute(surface, near);
  EXPECT_GT(map.samples(), 0u);
  EXPECT_THAT(test::error_of([&] { map.compute(std::vector<Vec3>(7), near); }),
              HasSubstr("8 vertices, not 7"));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(test::error_of([&] {
                map.compute(std::vector<Vec3>(8, {0, kNan, 0}), near);
              }),
              HasSubstr("too far"));
  EXPECT_EQ(map.samples(), 0u);
  EXPECT_THAT(test::error_of([&] { return GpuMap(surface, near, {.device = "no such device"}); }),
              HasSubstr("no such device"));
}

}  // namespace
}  // namespace sdm
