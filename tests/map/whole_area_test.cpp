// Every part of the area has a sample, also where faces are smaller than a texel.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/map.h>
#include <sdm/measure.h>
#include <sdm/places.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/triangle.h"
#include "map/statistics/texel_areas.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"
#include "support/thickness.h"

namespace sdm::test {
namespace {

double area_of(const Mesh& mesh) {
  long double area = 0;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto [a, b, c] = corners_of(mesh, face);
    area += 0.5 * norm(cross(b - a, c - a));
  }
  return static_cast<double>(area);
}

double area_of_samples(const Surface& surface) {
  const std::vector<double> areas = map::texel_areas(surface);
  long double area = 0;  // of a million numbers
  for (const std::uint32_t sample : surface.sample_texels()) area += areas[surface.map_faces()[sample]];
  return static_cast<double>(area);
}

/// A plate of 2 n² triangles in the unit square, whose vertices have a noise across it.
Mesh noisy_plate(std::uint32_t n, double noise) {
  Mesh mesh;
  std::mt19937 random(7);
  std::normal_distribution<double> height(0, noise);
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      mesh.positions.push_back({static_cast<double>(i) / n, static_cast<double>(j) / n, height(random)});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
    }
  return mesh;
}

/// The share of a triangle in which the linear function of these values at its corners is above a limit.
double share_above(std::array<double, 3> values, double limit) {
  std::ranges::sort(values);
  const auto& [least, middle, most] = values;
  if (limit <= least) return 1;
  if (limit >= most) return 0;
  if (limit >= middle) return (most - limit) * (most - limit) / ((most - least) * (most - middle));
  return 1 - (limit - least) * (limit - least) / ((most - least) * (middle - least));
}

/// The statistics of the height, which is linear in each face, by exact integration.
struct Exact {
  double area = 0, mean = 0, mean_abs = 0, rms = 0, beyond = 0;

  Exact(const Mesh& mesh, double limit) {
    for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
      const auto [a, b, c] = corners_of(mesh, face);
      const double of_face = 0.5 * norm(cross(b - a, c - a));
      const std::array z{a[2], b[2], c[2]};
      const double sum = z[0] + z[1] + z[2];
      area += of_face;
      mean += of_face * sum / 3;
      rms += of_face * (z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + sum * sum) / 12;
      beyond += of_face * (share_above(z, limit) + 1 - share_above(z, -limit));
    }
    mean /= area;
    rms = std::sqrt(rms / area);
    beyond /= area;
  }
};

TEST(WholeArea, AreasOfSamplesAddUpToThatOfTheMesh) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles})
    for (const std::uint32_t resolution : {64u, 100u, 1024u}) {
      const Mesh mesh = kind == AtlasKind::charts ? sphere(5) : ring(10);
      const Surface surface(mesh, {.kind = kind, .resolution = resolution});
      EXPECT_NEAR(area_of_samples(surface) / area_of(mesh), 1, 1e-12) << resolution;
    }
  // Two faces on the same texels: one of them owns all.
  Mesh twice;
  twice.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  twice.triangles = {{0, 1, 2}, {3, 4, 5}};
  twice.corner_uvs.assign(2, {Vec2{0.1, 0.1}, Vec2{0.8, 0.1}, Vec2{0.1, 0.8}});
  const Surface surface(twice, {.kind = AtlasKind::uv, .resolution = 64});
  EXPECT_NEAR(area_of_samples(surface) / area_of(twice), 1, 1e-12);
  ASSERT_EQ(surface.map_faces().size(), 64 * 64 + 1u);
  const std::uint32_t without = surface.map_faces().back();
  EXPECT_EQ(std::ranges::count(surface.texel_faces(), without), 0);
  EXPECT_GT(std::ranges::count(surface.texel_faces(), 1 - without), 1000);
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[2]; });
  EXPECT_NEAR(statistics(surface, map).mean, 0.5, 1e-6);
  EXPECT_EQ(area_fraction_without_texels(surface), 0.5);
}

TEST(WholeArea, NothingIsAddedWhereEveryFaceHasATexel) {
  const Surface surface(ring(10), {.resolution = 512});
  EXPECT_EQ(surface.map_faces().size(), surface.texel_faces().size());
  EXPECT_EQ(surface.owned_texels(), surface.sample_texels().size());
  EXPECT_EQ(area_fraction_without_texels(surface), 0);
  EXPECT_EQ(empty_map(surface).without_texel, 0u);
}

// Of 100,352 triangles; at 256² most have no texel. Within four times the standard error.
TEST(WholeArea, StatisticsOfADenseScanDoNotDependOnTheResolution) {
  const double noise = 0.003, limit = 0.004;
  const Mesh mesh = noisy_plate(224, noise);
  const Exact exact(mesh, limit);
  for (const std::uint32_t resolution : {128u, 256u, 400u, 512u, 1024u}) {
    SCOPED_TRACE(resolution);
    const Surface surface(mesh, {.resolution = resolution});
    if (resolution <= 256) {
      EXPECT_GT(area_fraction_without_texels(surface), 0.3);
    }
    const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[2]; });
    const DistanceStatistics found = statistics(surface, map);
    EXPECT_EQ(found.texels, surface.sample_texels().size());
    const double error = 4 / std::sqrt(static_cast<double>(mesh.triangles.size()));  // relative
    EXPECT_NEAR(found.mean, exact.mean, error * exact.rms);
    EXPECT_NEAR(found.rms, exact.rms, error * exact.rms);
    EXPECT_NEAR(area_fraction_beyond(surface, map, limit), exact.beyond, error * std::sqrt(exact.beyond));
    const ToleranceShares shares = tolerance_shares(surface, map, Tolerance(limit), 0);
    EXPECT_NEAR(shares.below + shares.above, exact.beyond, error * std::sqrt(exact.beyond));
  }
}

// The samples of faces without a texel, in all measures.
class OwnPoints : public testing::Test {
 protected:
  const Mesh mesh_ = sphere(4);
  Surface surface_{mesh_, {.resolution = 32}};
  const Mesh other_ = moved(sphere(3), {0.1, 0.2, 0.05});
  const Sites sites_{other_}, own_{mesh_};

  /// Calls check(index, point) for each.
  template <class Check>
  void for_each(const Check& check) const {
    const auto texels = static_cast<std::uint32_t>(surface_.texel_faces().size());
    ASSERT_GT(surface_.map_faces().size(), texels + 1000);
    for (std::uint32_t i = texels; i < surface_.map_faces().size(); ++i) check(i, surface_.texel_point(i));
  }
};

TEST_F(OwnPoints, LieInTheirFacesAndMoveWithThem) {
  std::vector<Vec3> weights;
  const auto weights_of = [&](std::uint32_t i, const Vec3& p) {
    const auto [a, b, c] = corners_of(surface_.mesh(), surface_.map_faces()[i]);
    const Vec3 n = cross(b - a, c - a);
    const double all = dot(n, n);
    const Vec3 w{dot(cross(c - b, p - b), n) / all, dot(cross(a - c, p - c), n) / all,
                 dot(cross(b - a, p - a), n) / all};
    EXPECT_NEAR(norm(w[0] * a + w[1] * b + w[2] * c - p), 0, 1e-14);
    return w;
  };
  Vec3 sum{};
  for_each([&](std::uint32_t i, const Vec3& p) {
    weights.push_back(weights_of(i, p));
    EXPECT_GE(std::ranges::min(weights.back()), -1e-12);
    sum += weights.back();
  });
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k] / static_cast<double>(weights.size()), 1.0 / 3, 0.02);

  std::vector<Vec3> positions = mesh_.positions;
  for (Vec3& p : positions) p = {2 * p[0] + p[1] * p[1], p[1] - 0.5 * p[2], p[2] * p[0] + 3};
  surface_.refit(positions);
  std::size_t next = 0;
  for_each([&](std::uint32_t i, const Vec3& p) {
    EXPECT_NEAR(norm(weights_of(i, p) - weights[next++]), 0, 1e-9);
  });
  const std::vector<Vec3> points = surface_.sample_points();
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_EQ(points[i], surface_.texel_point(surface_.sample_texels()[i]));
}

TEST_F(OwnPoints, HaveTheDistancesOfQueriesThere) {
  std::vector<Vec3> points, normals;
  for_each([&](std::uint32_t i, const Vec3& p) {
    const auto [a, b, c] = corners_of(mesh_, surface_.map_faces()[i]);
    points.push_back(p);
    normals.push_back(normalized(cross(b - a, c - a)));
  });
  const std::size_t first = surface_.texel_faces().size();
  const DistanceMap map = compute_map(surface_, sites_);
  ASSERT_EQ(map.distance.size(), surface_.map_faces().size());
  EXPECT_EQ(map.texels(), first);
  EXPECT_EQ(map.rows(), surface_.rows());
  const std::vector<ClosestPoint> closest = closest_points(sites_, points);
  const DistanceMap facing = compute_map(surface_, sites_, {.facing = 60});
  const FacingPoints faced = closest_facing_points(sites_, points, normals, 60);
  const DistanceMap along = compute_map(surface_, sites_, AlongOptions{});
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(std::abs(map.distance[first + i]), closest[i].distance, 1e-6);
    ASSERT_NEAR(std::abs(facing.distance[first + i]), faced.closest[i].distance, 1e-6);
    ASSERT_FALSE(std::isnan(along.distance[first + i]));
    const Vec3f& v = along.vector[first + i];
    ASSERT_NEAR(norm(cross(Vec3{v[0], v[1], v[2]}, normals[i])), 0, 1e-5);
  }
  const test::ThicknessMaps walls = test::thickness_maps(surface_, own_);
  const Exclusion exclusion(mesh_);
  const DistanceMap self = compute_map(surface_, own_, SelfOptions{.exclusion = exclusion});
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(walls.ball.distance[first + i], 2, 0.1);
    ASSERT_NEAR(walls.ray.distance[first + i], 2, 0.1);
    ASSERT_FALSE(std::isnan(self.distance[first + i]));
  }
}

// A dent that no texel shows.
TEST_F(OwnPoints, CountInExtremesAndPlaces) {
  const std::uint32_t face = surface_.map_faces().back();
  const auto index = static_cast<std::uint32_t>(surface_.map_faces().size() - 1);
  DistanceMap map = map_of(surface_, [](const Vec3&) { return 0; });
  map.distance[index] = -3;
  const std::vector<float> vertices(mesh_.positions.size(), 0);
  const Extremes found = extremes(surface_, map, vertices).value();
  EXPECT_EQ(found.min.distance, -3);
  EXPECT_EQ(found.min.point, surface_.texel_point(index));
  EXPECT_FALSE(found.min.at_vertex);
  const Places places = find_places(surface_, map, {}, {.tolerance = Tolerance(1)});
  ASSERT_EQ(places.largest.size(), 1u);
  EXPECT_EQ(places.largest[0].face, face);
  EXPECT_EQ(places.largest[0].sample, index);
  const auto [a, b, c] = corners_of(mesh_, face);
  EXPECT_NEAR(places.largest[0].area, 0.5 * norm(cross(b - a, c - a)), 1e-9);
  EXPECT_NEAR(area_fraction_beyond(surface_, map, 1), places.largest[0].area / area_of(mesh_), 1e-6);
}

// A cap of the sphere is one place, whatever of it the texels show.
TEST_F(OwnPoints, AreConnectedWithWhatIsAroundThem) {
  const DistanceMap map = map_of(surface_, [](const Vec3& p) { return p[2] > 0.5 ? 2 : 0; });
  const std::vector<float> vertices = at_vertices(mesh_, [](const Vec3& p) { return p[2] > 0.5 ? 2 : 0; });
  for (const bool with_vertices : {true, false}) {
    const Places places = find_places(surface_, map, with_vertices ? vertices : std::vector<float>(),
                                      {.tolerance = Tolerance(1)});
    ASSERT_EQ(places.largest.size(), 1u) << with_vertices;
    EXPECT_NEAR(places.largest[0].fraction, 0.25, 0.01);
  }
}

}  // namespace
}  // namespace sdm::test
