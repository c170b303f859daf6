
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/statistics.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// A cross product that does not share the code under test.
double texel_area(const Surface& surface, std::uint32_t face) {
  const auto [u, v] = surface.texel_edges(face);
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  return std::sqrt(x * x + y * y + z * z);
}

struct Naive {
  double min = 1e300, max = -1e300, mean = 0, rms = 0, p50 = 0, p95 = 0, p99 = 0;
  std::size_t texels = 0, negative = 0;
};

Naive naive(const Surface& surface, const DistanceMap& map) {
  Naive result;
  std::vector<std::pair<double, double>> values;
  double area = 0;
  for (std::size_t texel = 0; texel < map.distance.size(); ++texel) {
    const double d = map.distance[texel];
    if (!std::isfinite(d)) continue;
    const double weight = texel_area(surface, surface.texel_faces()[texel]);
    values.emplace_back(d, weight);
    area += weight, result.mean += weight * d, result.rms += weight * d * d;
    result.min = std::min(result.min, d), result.max = std::max(result.max, d);
    ++result.texels, result.negative += d < 0;
  }
  result.mean /= area, result.rms = std::sqrt(result.rms / area);
  std::ranges::sort(values);
  const auto percentile = [&](double share) {
    double below = 0;
    for (const auto& [d, weight] : values)
      if ((below += weight) >= share * area) return d;
    return values.back().first;
  };
  result.p50 = percentile(0.5), result.p95 = percentile(0.95), result.p99 = percentile(0.99);
  return result;
}

void expect_as_naive(const Surface& surface, const DistanceMap& map) {
  const DistanceStatistics found = statistics(surface, map);
  const Naive expected = naive(surface, map);
  const double close = 1e-5 * (expected.max - expected.min);
  EXPECT_EQ(found.texels, expected.texels);
  EXPECT_EQ(found.negative_texels, expected.negative);
  EXPECT_EQ(found.min, expected.min);
  EXPECT_EQ(found.max, expected.max);
  EXPECT_NEAR(found.mean, expected.mean, close);
  EXPECT_NEAR(found.rms, expected.rms, close);
  EXPECT_NEAR(found.p50, expected.p50, close);
  EXPECT_NEAR(found.p95, expected.p95, close);
  EXPECT_NEAR(found.p99, expected.p99, close);
}

// Faces of different stretch, so that weights matter.
TEST(Statistics, AgreeWithASumOverAllTexels) {
  const Surface surface(ring(20), {.resolution = 300});
  expect_as_naive(surface, map_of(surface, [](const Vec3& p) { return p[0] * std::abs(p[0]) + p[2]; }));
  for (const double none : {std::nan(""), std::numeric_limits<double>::infinity()})
    expect_as_naive(surface, map_of(surface, [none](const Vec3& p) { return p[0] < 0 ? p[1] : none; }));
}

TEST(Statistics, WeightTexelsByTheirSurfaceArea) {
  // Two triangles with the same texture coordinates' area but 1 and 9 units of surface: an atlas of its own
  // UVs.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {10, 0, 0}, {13, 0, 0}, {10, 6, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.corner_uvs = {{Vec2{0.1, 0.1}, Vec2{0.4, 0.1}, Vec2{0.1, 0.7}},
                     {Vec2{0.6, 0.1}, Vec2{0.9, 0.1}, Vec2{0.6, 0.7}}};
  const Surface surface(mesh, {.kind = AtlasKind::uv, .resolution = 400});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[0] < 5 ? -1 : 2; });
  const DistanceStatistics found = statistics(surface, map);
  EXPECT_NEAR(found.mean, (1 * -1 + 9 * 2) / 10.0, 0.02);
  EXPECT_EQ(found.p50, 2);
  EXPECT_NEAR(static_cast<double>(found.negative_texels) / static_cast<double>(found.texels), 0.5, 0.01);
  EXPECT_NEAR(area_fraction_beyond(surface, map, 1), 0.9, 0.01);
  EXPECT_NEAR(area_fraction_beyond(surface, map, 0.5), 1, 1e-9);
  EXPECT_EQ(area_fraction_beyond(surface, map, 2), 0);
}

// Regression: weights were areas in single precision, which vanish or overflow.
TEST(Statistics, HoldForMeshesOfAnySize) {
  const auto mean = [](double scale) {
    Mesh mesh = ring(10);
    for (Vec3& p : mesh.positions)
      for (double& x : p) x *= scale;
    const Surface surface(mesh, {.resolution = 128});
    const DistanceMap map = map_of(surface, [](const Vec3& p) { return std::abs(p[0]); });
    EXPECT_EQ(area_fraction_beyond(surface, map, 0), 1);
    return statistics(surface, map).mean / scale;
  };
  const double expected = mean(1);
  for (const double scale : {0x1p-90, 0x1p-30, 0x1p30, 0x1p90})  // powers of two: bit-identical atlas
    EXPECT_NEAR(mean(scale), expected, 1e-6 * expected);
}

TEST(Statistics, RejectMapsOfOtherSurfaces) {
  const Surface small(ring(10), {.resolution = 64}), large(ring(10), {.resolution = 128});
  const DistanceMap map = map_of(large, [](const Vec3&) { return 1; });
  EXPECT_THROW((void)statistics(small, map), Error);
  EXPECT_THROW((void)area_fraction_beyond(small, map, 1), Error);
}

TEST(Statistics, AreNaNWithoutAnyValue) {
  const Surface surface(ring(6), {.resolution = 128});
  for (const double none : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const DistanceMap map = map_of(surface, [none](const Vec3&) { return none; });
    const DistanceStatistics found = statistics(surface, map);
    EXPECT_EQ(found.texels, 0u);
    for (const double value : {found.min, found.max, found.mean, found.rms, found.p50, found.p95, found.p99})
      EXPECT_TRUE(std::isnan(value));
    EXPECT_EQ(area_fraction_beyond(surface, map, 1e30), 1);
  }
}

}  // namespace
}  // namespace sdm::test
