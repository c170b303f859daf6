// Values of O2 at the closest points of texels.
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/match.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "support/error_of.h"
#include "support/oracle.h"
#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

std::vector<float> positions_as_values(const Mesh& mesh) {
  std::vector<float> values;
  for (const Vec3& p : mesh.positions)
    for (const double x : p) values.push_back(static_cast<float>(x));
  return values;
}

struct Transfer : ::testing::Test {
  Mesh target = [] {
    Mesh mesh = ring(11, 0.7, {0.4, 0.1, 0.2});
    mesh.triangles.resize(150);
    return mesh;
  }();
  Surface surface{ring(12), {.resolution = 96}};
  Sites sites{target};
  DistanceMap map = compute_map(surface, sites, {.max_distance = 1});
  std::vector<float> positions = positions_as_values(sites.mesh());

  [[nodiscard]] std::vector<float> moved(const AttributeArray& array, bool fill = false) const {
    return transfer(surface, sites, map, array, {.fill = fill});
  }
};

// Positions are the attribute whose right value is known without a search: the point that the oracle finds.
TEST_F(Transfer, PositionsAreTheClosestPointsOfTheOracle) {
  const auto values = moved({positions, 3});
  ASSERT_EQ(values.size(), 3 * map.texels());
  std::size_t without = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    if (map.site_type[texel] == SiteType::none) {
      ++without;
      EXPECT_TRUE(std::isnan(values[3 * texel]) && std::isnan(values[3 * texel + 2]));
      continue;
    }
    const Vec3 query = surface.texel_point(texel);
    const Vec3 found{values[3 * texel], values[3 * texel + 1], values[3 * texel + 2]};
    ASSERT_NEAR(norm(found - query), oracle::brute_force(target, query), 1e-6) << texel;
  }
  EXPECT_GT(without, 0u);
  for (std::size_t i = 0; i < map.texels(); ++i)
    ASSERT_TRUE(surface.map_faces()[i] != kNone || std::isnan(values[3 * i])) << i;
}

TEST_F(Transfer, EveryDomainAndNumberOfComponentsAgrees) {
  const auto by_vertex = moved({positions, 3});
  std::vector<float> by_corner_values, wide, x_only, face_numbers;
  for (const Triangle& t : target.triangles) {
    face_numbers.push_back(static_cast<float>(face_numbers.size()));
    for (const std::uint32_t v : t)
      for (int k = 0; k < 3; ++k) by_corner_values.push_back(positions[3 * v + k]);
  }
  for (std::size_t v = 0; v < target.positions.size(); ++v) {
    x_only.push_back(positions[3 * v]);
    for (int k = 0; k < 5; ++k) wide.push_back(positions[3 * v + k % 3]);
  }
  const auto by_corner = moved({by_corner_values, 3, AttributeDomain::corner});
  const auto of_five = moved({wide, 5});
  const auto of_one = moved({x_only, 1});
  const auto faces = moved({face_numbers, 1, AttributeDomain::face});
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    if (map.site_type[texel] == SiteType::none) continue;
    ASSERT_EQ(of_one[texel], by_vertex[3 * texel]);
    for (std::size_t k = 0; k < 5; ++k) ASSERT_EQ(of_five[5 * texel + k], by_vertex[3 * texel + k % 3]);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(by_corner[3 * texel + k], by_vertex[3 * texel + k]);
    ASSERT_TRUE(map.site_type[texel] != SiteType::face ||
                faces[texel] == static_cast<float>(map.site[texel]));
    // Whatever the site, the point is one of the face.
    const auto face = static_cast<std::uint32_t>(faces[texel]);
    const Triangle& t = target.triangles[face];
    const Vec3 found{by_vertex[3 * texel], by_vertex[3 * texel + 1], by_vertex[3 * texel + 2]};
    ASSERT_LE(oracle::distance(found, target.positions[t[0]], target.positions[t[1]], target.positions[t[2]]),
              1e-6);
  }
}

TEST_F(Transfer, FollowsTheConstraintOfTheMap) {
  const Surface plate(ring(12), {.resolution = 48});
  const Sites other(ring(14, 0.95));
  const DistanceMap facing = compute_map(plate, other, {.facing = 60});
  const auto values = transfer(plate, other, facing, {positions_as_values(other.mesh()), 3}, {.fill = false});
  std::size_t compared = 0;
  for (const std::uint32_t texel : test::owned_texels(plate)) {
    if (facing.site_type[texel] == SiteType::none) continue;
    ++compared;
    const Vec3 query = plate.texel_point(texel);
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(values[3 * texel + k], query[k] + facing.vector[texel][k], 2e-6) << texel;
  }
  EXPECT_GT(compared, 500u);
}

// A part of a plate overhangs the other one, whose rim it is closest to: that edge belongs to the top, the
// side and, nearly, to the bottom.
TEST(TransferAtEdges, TakesTheFaceThatFacesTheSample) {
  const auto plate = [](double half_side, double half_height) {
    Mesh mesh = cube();
    for (Vec3& p : mesh.positions) p = {half_side * p[0], half_side * p[1], half_height * p[2]};
    return mesh;
  };
  const Surface surface(plate(1, 0.05), {.resolution = 128});
  const Sites sites(plate(0.9, 0.04));
  const auto height_of_normal = [](const Mesh& mesh, std::uint32_t face) {
    const Triangle& t = mesh.triangles[face];
    const Vec3& a = mesh.positions[t[0]];
    return normalized(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a))[2];
  };
  std::vector<float> heights;
  for (std::uint32_t f = 0; f < sites.mesh().triangles.size(); ++f)
    heights.push_back(static_cast<float>(height_of_normal(sites.mesh(), f)));
  const DistanceMap map = compute_map(surface, sites, {.facing = 60});
  const auto values = transfer(surface, sites, map, {heights, 1, AttributeDomain::face}, {.fill = false});
  std::size_t at_edges = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    ASSERT_EQ(values[texel],
              static_cast<float>(height_of_normal(surface.mesh(), surface.map_faces()[texel])));
    at_edges += map.site_type[texel] != SiteType::face;
  }
  EXPECT_GT(at_edges, 500u);
}

TEST_F(Transfer, FillsAllTexelsOfNoFaceAndNoOther) {
  const auto bare = moved({positions, 3}), filled = moved({positions, 3}, /*fill=*/true);
  std::array<float, 3> least, most;
  least.fill(INFINITY);
  most.fill(-INFINITY);
  for (std::size_t i = 0; i < bare.size(); ++i)
    if (!std::isnan(bare[i])) {
      least[i % 3] = std::min(least[i % 3], bare[i]);
      most[i % 3] = std::max(most[i % 3], bare[i]);
    }
  const std::uint32_t n = map.resolution;
  for (std::uint32_t y = 0; y < map.rows(); ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::size_t i = std::size_t{y} * n + x;
      if (surface.map_faces()[i] != kNone) {
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
          ASSERT_TRUE(filled[k] == bare[k] || (std::isnan(filled[k]) && std::isnan(bare[k])));
        continue;
      }
      // Means of values lie between them.
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_TRUE(filled[3 * i + k] >= least[k] - 1e-5f && filled[3 * i + k] <= most[k] + 1e-5f) << i;
    }
}

TEST_F(Transfer, NearestTexelFillsTheGutter) {
  std::vector<float> numbers;  // differ at each texel nearly everywhere
  std::mt19937 random(5);
  for (std::size_t v = 0; v < target.positions.size(); ++v)
    numbers.push_back(static_cast<float>(random() % 1000));
  const auto bare = moved({numbers, 1}), filled = moved({numbers, 1}, true);
  const auto n = static_cast<int>(map.resolution), rows = static_cast<int>(map.rows());
  std::size_t checked = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < n; ++x) {
      const int i = y * n + x;
      if (surface.map_faces()[i] != kNone) continue;
      constexpr int kBeyond = 1 << 20;
      const auto distance = [](int dx, int dy) {  // of rings, and then the length
        return 1000 * std::max(std::abs(dx), std::abs(dy)) + dx * dx + dy * dy;
      };
      int nearest = kBeyond;
      for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx)
          if (y + dy >= 0 && y + dy < rows && x + dx >= 0 && x + dx < n && !std::isnan(bare[i + dy * n + dx]))
            nearest = std::min(nearest, distance(dx, dy));
      if (nearest == kBeyond) continue;
      bool is_one_of_the_nearest = false;
      for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx)
          if (distance(dx, dy) == nearest && y + dy >= 0 && y + dy < rows && x + dx >= 0 && x + dx < n)
            is_one_of_the_nearest |= bare[i + dy * n + dx] == filled[i];
      ASSERT_TRUE(is_one_of_the_nearest) << x << ' ' << y;
      ++checked;
    }
  EXPECT_GT(checked, 100u);
}

TEST_F(Transfer, RefusesWhatDoesNotFit) {
  EXPECT_EQ(error_of([&] {
              (void)moved({std::span(positions).first(positions.size() - 3), 3});
            }),
            "an array of 3 components for each of " + std::to_string(target.positions.size()) +
                " vertices has " + std::to_string(positions.size()) + " values, not " +
                std::to_string(positions.size() - 3));
  EXPECT_EQ(error_of([&] {
              (void)moved({positions, 0});
            }),
            "an array to transfer needs at least one component");
  EXPECT_EQ(error_of([&] {
              (void)moved({{}, 1, AttributeDomain::face});
            }),
            "an array of 1 components for each of 150 faces has 150 values, not 0");
  const Surface other(ring(12), {.resolution = 64});
  EXPECT_EQ(error_of([&] {
              (void)transfer(other, sites, map, {positions, 3});
            }),
            "the map belongs to another surface: its number of texels differs");
}

TEST_F(Transfer, CornersMayShareRows) {
  std::vector<float> by_corner_values;
  for (const Triangle& t : target.triangles)
    for (const std::uint32_t v : t) by_corner_values.push_back(positions[3 * v]);
  std::vector<float> of_vertices;
  for (std::size_t v = 0; v < target.positions.size(); ++v) of_vertices.push_back(positions[3 * v]);
  std::vector<Triangle> rows = target.triangles;
  const auto own = moved({by_corner_values, 1, AttributeDomain::corner});
  const auto shared = moved({of_vertices, 1, AttributeDomain::corner, rows});
  rows[map.site[*std::ranges::find_if(
      surface.sample_texels(), [&](auto t) { return map.site_type[t] == SiteType::face; })]][1] = kNone;
  const auto with_gap = moved({of_vertices, 1, AttributeDomain::corner, rows});
  std::size_t in_gap = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    if (map.site_type[texel] == SiteType::none) continue;
    ASSERT_EQ(own[texel], shared[texel]);
    ASSERT_TRUE(std::isnan(with_gap[texel]) || with_gap[texel] == shared[texel]);
    in_gap += std::isnan(with_gap[texel]);
  }
  // What is missing does not spread.
  const auto filled = moved({of_vertices, 1, AttributeDomain::corner, rows}, /*fill=*/true);
  for (std::size_t i = 0; i < filled.size(); ++i)
    ASSERT_TRUE(surface.map_faces()[i] != kNone || std::isfinite(filled[i])) << i;
  EXPECT_GT(in_gap, 0u);
  EXPECT_EQ(error_of([&] {
              (void)moved({of_vertices, 1, AttributeDomain::vertex, rows});
            }),
            "rows of an array to transfer must be those of the corners of each face");
  EXPECT_EQ(error_of([&] {
              (void)moved({std::span(of_vertices).first(2), 1, AttributeDomain::corner, rows});
            }),
            "an array to transfer has 2 rows, but a corner refers to row 11");
}

TEST_F(Transfer, IsCancelled) {
  EXPECT_THROW((void)transfer(surface, sites, map, {positions, 3},
                              {.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

}  // namespace
}  // namespace sdm::test
