// Maps that stay on a device: their statistics are those of their distances, also of several parts.
#include <gmock/gmock.h>
#include <sdm/gpu.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "scenes/scene.h"
#include "support/degenerate.h"
#include "support/error_of.h"
#include "support/every_case.h"
#include "support/gpu_closest.h"
#include "support/map_checks.h"
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

void expect_closest(const GpuMap& map, const Surface& surface, const Sites& sites, const Mesh& o2,
                    const std::vector<double>& expected) {
  expect_map(map, expected);
  EXPECT_EQ(test::wrong_closest(map, sites, o2, surface.sample_points(), expected), 0u);
}

TEST(GpuMap, StatisticsAreThoseOfTheDistances) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 256});
  const Sites apart(test::load("head.off", "fit,translate:0.9:0:0")), mixed(test::load("head.off", "fit"));
  GpuMap map(surface, apart, {.closest = true});
  expect_closest(map, surface, apart, apart.mesh(), expected_distances(surface, apart));
  map.compute(surface, mixed);
  expect_closest(map, surface, mixed, mixed.mesh(), expected_distances(surface, mixed));
  EXPECT_THAT(map.statistics().results, testing::MatchesRegex("device \\(single precision, ± .*\\)"));
}

TEST(GpuMap, MapsBesideEachOther) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 128});
  const Sites sites(test::load("head.off", "fit,translate:0.5:0:0"));
  const std::vector<double> expected = expected_distances(surface, sites);
  std::jthread beside([&] { expect_map(GpuMap(surface, sites), expected); });
  expect_map(GpuMap(surface, sites), expected);
}

// Frames of both meshes by their vertices only: the tree is refitted on the device, by the map and by the
// engine.
struct Frames : testing::TestWithParam<scenes::SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Frames,
                         testing::Values(scenes::SceneKind::letters, scenes::SceneKind::bunnies),
                         [](const auto& kind) {
                           return std::string(kind.param == scenes::SceneKind::letters ? "letters"
                                                                                       : "bunnies");
                         });

TEST_P(Frames, EqualTheOtherEngines) {
  const int frames = test::every_case() ? 100 : 3;
  scenes::Scene scene(GetParam(), {.mesh = test::mesh_file("bunny.obj")});
  const auto positions = [&](int body) { return scene.bodies()[body].mesh.positions; };
  Surface surface(scene.bodies()[0].mesh, {.resolution = test::every_case() ? 256u : 96u});
  Sites sites(scene.bodies()[1].mesh);
  const Sites first(scene.bodies()[1].mesh);
  GpuMap map(surface, first, {.closest = true});
  const auto engine = make_engine("gpu"), reference = make_engine("reference"), cpu = make_engine("cpu");
  for (int frame = 0; frame < frames; ++frame) {
    SCOPED_TRACE(frame);
    for (int step = 0; step < (test::every_case() ? 1 : 20); ++step) scene.advance();
    surface.refit(positions(0));
    sites.refit(positions(1));
    map.compute(positions(0), positions(1));
    const DistanceMap found = compute_map(surface, sites, {.engine = engine}),
                      exact = compute_map(surface, sites, {.engine = reference}),
                      by_cpu = compute_map(surface, sites, {.engine = cpu});
    test::Disagreements from_cpu(1e-6 * test::scene_diagonal(surface.mesh(), sites.mesh()));
    std::vector<double> expected;
    std::size_t different = 0;
    for (const std::uint32_t t : surface.sample_texels()) {
      different += found.distance[t] == exact.distance[t] && found.site[t] == exact.site[t] ? 0 : 1;
      from_cpu.compare(t, found.distance[t], by_cpu.distance[t]);
      expected.push_back(std::abs(static_cast<double>(exact.distance[t])));
    }
    EXPECT_EQ(different, 0u);
    EXPECT_TRUE(from_cpu.none());
    expect_closest(map, surface, sites, sites.mesh(), expected);
  }
}

// Needles and points of which a device computes the frames.
TEST(GpuMap, RefitsOfDegenerateFaces) {
  const Surface surface(test::sphere(2), {.resolution = 64});
  for (std::uint32_t seed = 1; seed < 9; ++seed) {
    std::mt19937 random(seed);
    Mesh soup = test::degenerate_soup(300, random);
    Sites sites(soup);
    GpuMap map(surface, sites, {.closest = true});
    for (Vec3& p : soup.positions) p = Vec3{p[0], (seed % 2 == 0 ? 1e-3 : 1.2) * p[1], p[2] + 0.3 * p[0]};
    map.compute(surface.mesh().positions, soup.positions);
    sites.refit(soup.positions);
    expect_closest(map, surface, sites, soup, expected_distances(surface, sites));
  }
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
  EXPECT_THAT(test::error_of([&] { map.compute(surface.mesh().positions, std::vector<Vec3>(7)); }),
              HasSubstr("8 vertices, not 7"));
  EXPECT_THAT(test::error_of([&] {
                map.compute(surface.mesh().positions, std::vector<Vec3>(8, {0, kNan, 0}));
              }),
              HasSubstr("vertex 0 of O2 is not finite"));
  map.compute(surface.mesh().positions, near.mesh().positions);
  EXPECT_GT(map.samples(), 0u);
  EXPECT_THAT(test::error_of([&] { return map.closest(); }), HasSubstr("no closest points"));
  EXPECT_THAT(test::error_of([&] { return GpuMap(surface, near, {.device = "no such device"}); }),
              HasSubstr("no such device"));
}

}  // namespace
}  // namespace sdm
