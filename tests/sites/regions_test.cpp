// Every region of point and triangle: three vertices, three edges, the interior on both sides, and triangles
// without area.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <random>
#include <vector>

#include "support/engines.h"
#include "support/map_checks.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

class Regions : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] ClosestPoint closest(const Sites& sites, const Vec3& query) const {
    return closest_points(sites, std::vector{query}, {.engine = make_engine(GetParam())})[0];
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, Regions, testing::ValuesIn(test::engine_names()), test::engine_name);

constexpr Box kUnit{{-1, -1, -1}, {1, 1, 1}};

void expect_closest(const ClosestPoint& actual, SiteType type, std::uint32_t site, const Vec3& point,
                    const Vec3& query) {
  EXPECT_EQ(actual.type, type);
  EXPECT_EQ(actual.site, site);
  EXPECT_EQ(actual.face, 0u);
  EXPECT_NEAR(norm(actual.point - point), 0, 1e-6);
  EXPECT_NEAR(actual.distance, norm(point - query), 1e-6);
}

TEST_P(Regions, OfRandomTriangles) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.1, 1);
  int triangles = 0;
  while (triangles < 200) {
    std::array<Vec3, 3> p;
    for (Vec3& corner : p) corner = test::random_point(kUnit, random);
    const Vec3 normal = normalized(cross(p[1] - p[0], p[2] - p[0]));
    if (norm(cross(p[1] - p[0], p[2] - p[0])) < 0.1) continue;
    ++triangles;
    const Sites sites(Mesh{.positions = {p.begin(), p.end()}, .triangles = {{0, 1, 2}}, .corner_uvs = {}});

    for (const double side : {-1.0, 0.0, 1.0}) {
      const double u = unit(random), v = unit(random), w = unit(random);
      const Vec3 inside = (1 / (u + v + w)) * (u * p[0] + v * p[1] + w * p[2]);
      const Vec3 above = inside + side * normal;
      expect_closest(closest(sites, above), SiteType::face, 0, inside, above);
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = (k + 1) % 3, previous = (k + 2) % 3;
      // The region of the edge lies between the two half-planes of the edge's own outward normal and the
      // face's normal.
      const Vec3 outward = normalized(cross(p[next] - p[k], normal));
      const double t = 0.9 * unit(random), height = 2 * unit(random) - 1;
      const Vec3 on_edge = p[k] + t * (p[next] - p[k]);
      const Vec3 beside = on_edge + unit(random) * outward + height * normal;
      const std::array<std::uint32_t, 2> ends{std::min(k, next), std::max(k, next)};
      const auto edge =
          static_cast<std::uint32_t>(std::ranges::find(sites.edges(), ends) - sites.edges().begin());
      expect_closest(closest(sites, beside), SiteType::edge, edge, on_edge, beside);
      // The region of the vertex is what lies beyond both of its edges: the opposite of both directions at
      // once.
      const Vec3 to_next = p[next] - p[k], to_previous = p[previous] - p[k];
      const Vec3 bisector = normalized(to_next) + normalized(to_previous);
      const Vec3 beyond = p[k] - unit(random) * bisector + height * normal;
      expect_closest(closest(sites, beyond), SiteType::vertex, k, p[k], beyond);
    }
    for (std::uint32_t k = 0; k < 3; ++k) {  // at the vertices themselves any site that touches is right
      const ClosestPoint at = closest(sites, p[k]);
      EXPECT_NEAR(at.distance, 0, 1e-6);
      EXPECT_NEAR(test::distance_to_site(sites, at.type, at.site, p[k]), 0, 1e-6);
    }
  }
}

TEST_P(Regions, OfFacesWithoutArea) {
  std::mt19937 random(3);
  // Collinear corners, in every order; a good triangle far away, for a mesh needs some area.
  for (const Triangle& order : {Triangle{0, 1, 2}, Triangle{1, 2, 0}, Triangle{2, 0, 1}, Triangle{0, 2, 1}}) {
    const Mesh mesh{.positions = {{0, 0, 0}, {1, 2, 3}, {3, 6, 9}, {50, 0, 0}, {51, 0, 0}, {50, 1, 0}},
                    .triangles = {order, {3, 4, 5}},
                    .corner_uvs = {}};
    const Sites sites(mesh);
    std::vector<Vec3> queries;
    queries.reserve(303);
    for (int i = 0; i < 300; ++i) queries.push_back(test::random_point({{-5, -5, -5}, {8, 11, 14}}, random));
    queries.push_back({0.5, 1, 1.5});
    queries.push_back({-1, -2, -3});
    queries.push_back({4, 8, 12});
    std::vector<double> expected;
    expected.reserve(queries.size());
    for (const Vec3& q : queries)
      expected.push_back(oracle::distance(q, mesh.positions[0], mesh.positions[2]));
    const auto found = closest_points(sites, queries, {.engine = make_engine(GetParam())});
    test::expect_closest_points(sites, queries, found, expected, 1e-6 * 60);
    for (const ClosestPoint& c : found) EXPECT_EQ(c.face, 0u);
  }
}

TEST_P(Regions, CollapsedAndDuplicateFacesAddNothing) {
  Mesh mesh = test::cube();
  const Sites clean(mesh);
  mesh.triangles.push_back({3, 3, 3});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back(mesh.triangles[4]);
  const Sites sites(mesh);
  EXPECT_TRUE(sites.closed());
  std::mt19937 random(4);
  std::vector<Vec3> queries;
  queries.reserve(1000);
  for (int i = 0; i < 1000; ++i) queries.push_back(test::random_point({{-3, -3, -3}, {3, 3, 3}}, random));
  const auto expected = closest_points(clean, queries, {.engine = make_engine(GetParam())});
  const auto found = closest_points(sites, queries, {.engine = make_engine(GetParam())});
  for (std::size_t i = 0; i < queries.size(); ++i) {
    EXPECT_NEAR(found[i].distance, expected[i].distance, 1e-6);
    EXPECT_LT(found[i].face, 12u);
  }
}

}  // namespace
}  // namespace sdm
