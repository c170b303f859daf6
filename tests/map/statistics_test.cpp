#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <sdm/statistics.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "map/statistics/texel_areas.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

struct Naive {
  double min = 1e300, max = -1e300, mean = 0, rms = 0, mean_abs = 0, negative_area = 0;
  std::vector<std::pair<double, double>> values, magnitudes;  ///< with their weights, sorted
  double area = 0;
  std::size_t texels = 0, negative = 0;

  [[nodiscard]] double percentile(const std::vector<std::pair<double, double>>& of, double share) const {
    double below = 0;
    for (const auto& [d, weight] : of)
      if ((below += weight) >= share * area) return d;
    return of.back().first;
  }
};

Naive naive(const Surface& surface, const DistanceMap& map) {
  Naive result;
  const std::vector<double> areas = map::texel_areas(surface);
  for (std::size_t texel = 0; texel < map.distance.size(); ++texel) {
    const double d = map.distance[texel];
    if (!std::isfinite(d)) continue;
    const double weight = areas[surface.map_faces()[texel]];
    result.values.emplace_back(d, weight);
    result.magnitudes.emplace_back(std::abs(d), weight);
    result.area += weight;
    result.mean += weight * d;
    result.rms += weight * d * d;
    result.mean_abs += weight * std::abs(d);
    result.negative_area += d < 0 ? weight : 0;
    result.min = std::min(result.min, d);
    result.max = std::max(result.max, d);
    ++result.texels;
    result.negative += d < 0;
  }
  result.mean /= result.area;
  result.rms = std::sqrt(result.rms / result.area);
  result.mean_abs /= result.area;
  std::ranges::sort(result.values);
  std::ranges::sort(result.magnitudes);
  return result;
}

void expect_as_naive(const DistanceStatistics& found, const Naive& expected) {
  const double close = 1e-5 * (expected.max - expected.min);
  EXPECT_EQ(found.texels, expected.texels);
  EXPECT_EQ(found.negative_texels, expected.negative);
  EXPECT_EQ(found.min, expected.min);
  EXPECT_EQ(found.max, expected.max);
  EXPECT_EQ(found.max_abs, std::max(-expected.min, expected.max));
  EXPECT_NEAR(found.mean, expected.mean, close);
  EXPECT_NEAR(found.mean_abs, expected.mean_abs, close);
  EXPECT_NEAR(found.rms, expected.rms, close);
  EXPECT_NEAR(found.negative_area_fraction, expected.negative_area / expected.area, 1e-6);
  const std::vector<std::pair<double, double>> percentiles{
      {0.01, found.p01}, {0.05, found.p05}, {0.5, found.p50}, {0.95, found.p95}, {0.99, found.p99}};
  for (const auto& [share, value] : percentiles)
    EXPECT_NEAR(value, expected.percentile(expected.values, share), close) << share;
  const std::vector<std::pair<double, double>> magnitudes{
      {0.5, found.p50_abs}, {0.95, found.p95_abs}, {0.99, found.p99_abs}, {0.999, found.p999_abs}};
  for (const auto& [share, value] : magnitudes)
    EXPECT_NEAR(value, expected.percentile(expected.magnitudes, share), close) << share;
}

void expect_as_naive(const Surface& surface, const DistanceMap& map) {
  expect_as_naive(statistics(surface, map), naive(surface, map));
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

// Bands and bins, against sums over all texels. Some distances are equal to an edge.
TEST(Statistics, BandsAndHistogramsHoldTheAreaBetweenTheirEdges) {
  const Surface surface(ring(20), {.resolution = 200});
  const DistanceMap map = map_of(surface, [](const Vec3& p) {
    return p[2] > 0.38 ? std::nan("") : std::round(40 * p[0]) / 32;  // multiples of 1/32: exact
  });
  const std::vector<double> areas = map::texel_areas(surface);
  double all = 0;
  const auto area_if = [&](const auto& holds) {
    double area = 0;
    all = 0;
    for (const std::uint32_t texel : surface.sample_texels()) {
      const double weight = areas[surface.map_faces()[texel]];
      all += weight;
      if (holds(map.distance[texel])) area += weight;
    }
    return area / all;
  };

  const std::vector<double> edges{-0.5, 0, 0.5};
  for (const double accuracy : {0.0, 0.04}) {
    const std::vector<DistanceBand> bands =
        distance_bands(surface, map, edges, {.accuracy = accuracy, .centre = 0.25});
    ASSERT_EQ(bands.size(), 4u);
    EXPECT_EQ(bands[0].lower, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(bands[1].lower, -0.5);
    EXPECT_EQ(bands[3].upper, std::numeric_limits<double>::infinity());
    const double a = accuracy;
    EXPECT_NEAR(bands[0].area_fraction, area_if([a](double d) { return d < -0.5 - a; }), 1e-6);
    EXPECT_NEAR(bands[1].area_fraction, area_if([a](double d) { return d >= -0.5 - a && d < -a; }), 1e-6);
    EXPECT_NEAR(bands[2].area_fraction, area_if([a](double d) { return d >= -a && d <= 0.5 + a; }), 1e-6);
    EXPECT_NEAR(bands[3].area_fraction, area_if([a](double d) { return d > 0.5 + a; }), 1e-6);
    EXPECT_GT(bands[2].area_fraction, 0.1);
    EXPECT_NEAR(bands[2].area_fraction, tolerance_shares(surface, map, Tolerance(0, 0.5), accuracy).within,
                accuracy == 0 ? 1e-12 : 1e-6);
  }

  const DistanceHistogram histogram = distance_histogram(surface, map, {-0.75, 0.5}, 5);
  EXPECT_NEAR(histogram.below, area_if([](double d) { return d < -0.75; }), 1e-6);
  EXPECT_NEAR(histogram.above, area_if([](double d) { return d > 0.5; }), 1e-6);
  EXPECT_NEAR(histogram.without_value, area_if([](double d) { return std::isnan(d); }), 1e-6);
  ASSERT_EQ(histogram.area_fractions.size(), 5u);
  double sum = histogram.below + histogram.above + histogram.without_value;
  for (int bin = 0; bin < 5; ++bin) {
    const double lo = -0.75 + 0.25 * bin, hi = lo + 0.25;
    const double expected = area_if([&](double d) { return d >= lo && (d < hi || (bin == 4 && d == hi)); });
    EXPECT_NEAR(histogram.area_fractions[bin], expected, 1e-6) << bin;
    sum += histogram.area_fractions[bin];
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_THROW((void)distance_bands(surface, map, std::vector<double>{0, 0}), Error);
  EXPECT_THROW((void)distance_histogram(surface, map, {1, 1}, 5), Error);
  EXPECT_THROW((void)distance_histogram(surface, map, {0, 1}, 0), Error);
}

// The statistics of a part are those of a map whose other texels have no value.
TEST(PartStatistics, AreThoseOfAMapOfThePartAlone) {
  const Mesh mesh = joined(ring(12), moved(ring(8), {5, 0, 0}));
  const Surface surface(mesh, {.resolution = 256});
  const DistanceMap map =
      map_of(surface, [](const Vec3& p) { return p[1] > 0.9 ? std::nan("") : p[0] + p[1]; });
  const std::vector<std::uint32_t> components = face_components(mesh);
  const std::vector<PartStatistics> parts =
      part_statistics(surface, map, components, 2, {.tolerance = Tolerance(-0.5, 4)});
  ASSERT_EQ(parts.size(), 2u);
  const std::vector<double> areas = map::texel_areas(surface);
  double area = 0;
  for (std::uint32_t p = 0; p < 2; ++p) {
    DistanceMap alone = map;
    double part_area = 0, within = 0;
    for (const std::uint32_t texel : surface.sample_texels()) {
      const std::uint32_t face = surface.map_faces()[texel];
      if (components[face] != p) {
        alone.distance[texel] = std::nanf("");
        continue;
      }
      const double weight = areas[face], d = map.distance[texel];
      part_area += weight;
      within += d >= -0.5 && d <= 4 ? weight : 0;
    }
    expect_as_naive(parts[p].distance, naive(surface, alone));
    EXPECT_EQ(parts[p].faces, p == 0 ? 288u : 128u);
    EXPECT_EQ(parts[p].box.lower[0] > 2, p == 1);
    EXPECT_NEAR(parts[p].tolerance.value().within, within / part_area, 1e-6);
    const ToleranceShares& t = *parts[p].tolerance;
    EXPECT_NEAR(t.below + t.within + t.above + t.without_value, 1, 1e-9);
    EXPECT_GT(t.without_value, 0);
    area += parts[p].area_fraction;
  }
  EXPECT_NEAR(area, 1, 1e-9);

  std::vector<std::uint32_t> none(components.size(), kNone);
  none[3] = 1;
  EXPECT_EQ(part_statistics(surface, map, none, 2)[0].distance.texels, 0u);
  EXPECT_EQ(part_statistics(surface, map, none, 2)[1].faces, 1u);
  EXPECT_THROW((void)part_statistics(surface, map, components, 1), Error);
  EXPECT_THROW((void)part_statistics(surface, map, std::span(components).first(5), 2), Error);
}

TEST(PartStatistics, ComponentsAreNumberedByTheirFirstFaces) {
  Mesh mesh = joined(square(1, 0), square(1, 3));
  std::swap(mesh.triangles[1], mesh.triangles[2]);
  EXPECT_EQ(face_components(mesh), (std::vector<std::uint32_t>{0, 1, 0, 1}));
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
