// Difficult inputs: ties everywhere, contact, extreme scales, slivers, soups.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <random>
#include <vector>

#include "geometry/vec.h"
#include "support/engines.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm {
namespace {

class HardCases : public testing::TestWithParam<test::EngineOnTarget> {
 protected:
  HardCases() : target_(GetParam().target) {}

  /// Maps and closest points against brute force; the tolerance is relative to the scene's diagonal.
  void expect_exact(const Mesh& o1, const Mesh& o2, std::uint32_t resolution = 64) const {
    const Surface surface(o1, {.resolution = resolution});
    const Sites sites(o2);
    const double tolerance = 1e-6 * test::scene_diagonal(o1, o2);
    const std::vector<Vec3> points = surface.sample_points();
    const auto expected = test::evaluate([&](const Vec3& p) { return oracle::brute_force(o2, p); }, points);
    test::expect_map(surface, sites, compute_map(surface, sites, {.engine = make_engine(GetParam().name)}),
                     expected, tolerance);
    test::expect_closest_points(sites, points,
                                closest_points(sites, points, {.engine = make_engine(GetParam().name)}),
                                expected, tolerance);
  }

 private:
  test::UseSimdTarget target_;
};
INSTANTIATE_TEST_SUITE_P(Engines, HardCases, testing::ValuesIn(test::engines_on_targets()),
                         test::engine_on_target_name);

TEST_P(HardCases, ConcentricSpheres) {
  expect_exact(test::sphere(2), test::placed(test::sphere(3), "scale:2"));
  expect_exact(test::placed(test::sphere(2), "scale:0.001"), test::sphere(4));
}

TEST_P(HardCases, EquidistantSites) {
  const Sites sites(test::sphere(5));
  const std::vector<Vec3> centre(1000, Vec3{});
  const double expected = oracle::brute_force(sites.mesh(), {});
  test::expect_closest_points(sites, centre,
                              closest_points(sites, centre, {.engine = make_engine(GetParam().name)}),
                              std::vector<double>(centre.size(), expected), 1e-6);
}

TEST_P(HardCases, CoplanarContact) {
  expect_exact(test::cube(), test::placed(test::cube(), "translate:2:0.5:0.25"));
  expect_exact(test::cube(), test::placed(test::cube(), "translate:2:2:0"));
}

TEST_P(HardCases, IdenticalMeshes) {
  const Mesh mesh = test::load("head.off", "fit");
  const Surface surface(mesh, {.resolution = 256});
  const Sites sites(mesh);
  test::expect_map(surface, sites, compute_map(surface, sites, {.engine = make_engine(GetParam().name)}),
                   std::vector<double>(surface.sample_texels().size(), 0.0),
                   1e-6 * test::scene_diagonal(mesh, mesh));
}

// A face whose third corner is on its longest side up to rounding: its normal is noise, by which distant
// points may appear to lie over the face.
TEST_P(HardCases, SliversWhoseNormalIsNoise) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr Box kBox{{-1, -1, -1}, {1, 1, 1}};
  for (int i = 0; i < 500; ++i) {
    Mesh mesh{.positions = {{-.6, .9, .9}, {0, -.4, -.7}, {.4, -.8, 0}},
              .triangles = {{0, 1, 2}, {1, 2, 3}},
              .corner_uvs = {}};
    double t = 0.5, s = 0.7;
    if (i > 0) {
      for (Vec3& p : mesh.positions) p = test::random_point(kBox, random);
      t = unit(random);
      s = unit(random);
    }
    const Vec3 a = mesh.positions[1], b = mesh.positions[2];
    mesh.positions.push_back(t * a + (1 - t) * b);
    const Sites sites(mesh);
    std::vector<Vec3> queries{(1 - s) * a + s * b};
    for (int k = 0; k < 20; ++k) queries.push_back(test::random_point(kBox, random));
    const auto expected =
        test::evaluate([&](const Vec3& p) { return oracle::brute_force(mesh, p); }, queries);
    ASSERT_NEAR(expected[0], 0, 1e-12);
    const auto closest = closest_points(sites, queries, {.engine = make_engine(GetParam().name)});
    for (std::size_t k = 0; k < queries.size(); ++k) {
      EXPECT_NEAR(closest[k].distance, expected[k], 1e-9);
      EXPECT_NEAR(norm(closest[k].point - queries[k]), closest[k].distance, 1e-12);
    }
  }
}

TEST_P(HardCases, TinyMeshesFarAway) {
  expect_exact(test::cube(), test::placed(test::sphere(1), "scale:1e-6,translate:1000:200:-300"));
  expect_exact(test::cube(), test::placed(test::sphere(1), "scale:1e-6,translate:1:1:1"));
  expect_exact(test::placed(test::cube(), "scale:1e-6"), test::placed(test::sphere(3), "translate:0:0:1.5"));
}

TEST_P(HardCases, ExtremeUnits) {
  for (const char* scale : {"scale:1e-12", "scale:1e12", "scale:1e-30", "scale:1e30"}) {
    SCOPED_TRACE(scale);
    expect_exact(test::placed(test::cube(), scale),
                 test::placed(test::sphere(2), "translate:0.5:0.7:0.9," + std::string(scale)), 32);
  }
}

TEST_P(HardCases, SmallDetailFarFromTheOrigin) {
  const std::string away = "scale:0.001,translate:100000:-100000:100000";
  expect_exact(test::placed(test::cube(), away),
               test::placed(test::sphere(2), "translate:0.5:0.7:0.9," + away));
}

TEST_P(HardCases, Slivers) {
  // A fan of needles, a thousand times longer than wide and worse, of which many share the tip.
  for (const double width : {1e-3, 1e-6, 1e-9, 1e-12}) {
    SCOPED_TRACE(width);
    const Mesh fan = test::needles(width);
    expect_exact(test::placed(test::sphere(2), "translate:0.5:0:0"), fan);
    expect_exact(test::placed(test::sphere(2), "scale:0.01,translate:0.5:0:0.02"), fan);
  }
}

// Regression: in single precision, the height over a thin face with a flat angle had an error of that of the
// normal times the distance from a corner, so that single points missed the nearest face.
TEST_P(HardCases, StackedCaps) {
  constexpr double kApart = 1e-6;
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (const double width : {1e-3, 1e-4, 1e-5})
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3 up = normalized({normal(random), normal(random), normal(random)});
      Mesh mesh;
      Vec3 top{};
      for (std::uint32_t i = 0; i < 8; ++i) {
        const Vec3 along = normalized(cross(up, {normal(random), normal(random), normal(random)})),
                   across = width * cross(up, along);
        top = i * kApart * up;
        for (const Vec3& p :
             {top - along - 0.3 * across, top + along - 0.3 * across, top + 0.1 * along + across})
          mesh.positions.push_back(p);
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      const Sites sites(mesh);
      for (const double height : {0.0, 0.01, 0.5}) {
        const std::vector<Vec3> query{top + height * up};
        const auto closest = closest_points(sites, query, {.engine = make_engine(GetParam().name)});
        EXPECT_NEAR(closest[0].distance, height, 1e-9) << width;
      }
    }
}

// Regression: in single precision, points on the extension of a flat triangle passed its walls.
TEST_P(HardCases, CapsAlmostWithoutHeight) {
  for (const double height : {1e-5, 1e-7, 1e-9, 1e-12, 0.0}) {
    SCOPED_TRACE(height);
    Mesh caps = test::placed(test::cube(0.01), "translate:-1:0:0");
    const auto first = static_cast<std::uint32_t>(caps.positions.size());
    caps.positions.insert(caps.positions.end(), {{0, 0.3, 0}, {1, 0.3, 0}, {0.5, 0.3 + height, 0}});
    caps.triangles.push_back({first, first + 1, first + 2});
    expect_exact(test::placed(test::sphere(2), "scale:0.5,translate:3:0.3:0"), caps);
    expect_exact(test::placed(test::sphere(2), "scale:0.5,translate:0.5:0.3:0"), caps);
  }
}

TEST_P(HardCases, SingleTriangle) {
  const Mesh triangle = test::single_triangle();
  expect_exact(test::sphere(2), triangle);
  expect_exact(triangle, test::sphere(2));
  expect_exact(triangle, triangle);
}

TEST_P(HardCases, Soup) {
  std::mt19937 random(5);
  for (const std::size_t count : {3u, 17u, 64u, 500u, 2000u})
    expect_exact(test::sphere(2), test::soup(count, random));
}

TEST_P(HardCases, ManyFacesOnOneVertexAndOneEdge) {
  std::mt19937 random(6);
  const Box unit{{-1, -1, -1}, {1, 1, 1}};
  Mesh book{
      .positions = {{0, 0, -0.5}, {0, 0, 0.5}}, .triangles = {}, .corner_uvs = {}};  // pages on one spine
  Mesh star{.positions = {{0, 0, 0}}, .triangles = {}, .corner_uvs = {}};
  for (std::uint32_t i = 0; i < 300; ++i) {
    book.positions.push_back(test::random_point(unit, random));
    book.triangles.push_back({0, 1, i + 2});
    star.positions.push_back(test::random_point(unit, random));
    star.positions.push_back(test::random_point(unit, random));
    star.triangles.push_back({0, 2 * i + 1, 2 * i + 2});
  }
  expect_exact(test::sphere(2), book);
  expect_exact(test::sphere(2), star);
}

TEST_P(HardCases, RandomQueries) {
  std::mt19937 random(7);
  const Mesh mesh = test::soup(1000, random);
  const Sites sites(mesh);
  std::vector<Vec3> queries;  // scattered, so that neighbours share nothing
  queries.reserve(5000);
  for (int i = 0; i < 5000; ++i) queries.push_back(test::random_point({{-2, -2, -2}, {3, 3, 3}}, random));
  const auto expected = test::evaluate([&](const Vec3& p) { return oracle::brute_force(mesh, p); }, queries);
  test::expect_closest_points(sites, queries,
                              closest_points(sites, queries, {.engine = make_engine(GetParam().name)}),
                              expected, 1e-6 * 8);
  EXPECT_TRUE(closest_points(sites, {}, {.engine = make_engine(GetParam().name)}).empty());
}

}  // namespace
}  // namespace sdm
