// The sign at every texel against CGAL's Side_of_triangle_mesh.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/vec.h"
#include "support/engines.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

/// Compares the sign at every texel farther than 1e-5 of the scene's diagonal from O2, and asks for both
/// kinds.
void expect_signs(const Mesh& o1, const Mesh& o2, SignMethod method = SignMethod::automatic,
                  std::uint32_t resolution = 256) {
  const Surface surface(o1, {.resolution = resolution});
  const Sites sites(o2);
  const double least = 1e-5 * test::scene_diagonal(o1, o2);
  const oracle::CgalInside cgal(o2);
  const std::vector<double> inside = test::evaluate(cgal, surface.sample_points());
  for (const std::string& engine : test::engine_names()) {
    SCOPED_TRACE(engine);
    const DistanceMap map = compute_map(surface, sites, {.engine = make_engine(engine), .sign = method});
    EXPECT_EQ(map.sign.method, SignMethod::exact) << "also where winding numbers are asked for";
    std::size_t counts[2] = {0, 0}, wrong = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const double distance = map.distance[surface.sample_texels()[i]];
      ASSERT_FALSE(std::isnan(distance));
      if (std::abs(distance) <= least) continue;
      ++counts[inside[i] != 0];
      wrong += (distance < 0) != (inside[i] != 0);
    }
    EXPECT_EQ(wrong, 0u) << "of " << counts[0] << " outside and " << counts[1] << " inside";
    EXPECT_GT(counts[0], 0u);
    EXPECT_GT(counts[1], 0u);
  }
}

struct Scene {
  const char *o1, *steps1, *o2, *steps2;
};
void PrintTo(const Scene& s, std::ostream* out) {
  *out << s.o1 << " [" << s.steps1 << "] " << s.o2 << " [" << s.steps2 << ']';
}

// O2 is closed and does not intersect itself.
const Scene kScenes[] = {
    {"bunny.obj", "fit", "armadillo.off", "fit"},
    {"head.off", "fit", "elephant.off", "fit"},
    {"armadillo.off", "fit", "dino.off", "fit"},
    {"pig.off", "fit", "knot2.off", "fit"},
    {"triceratops.off", "fit", "anchor_dense.off", "fit"},
    {"lion-head.off", "fit", "fandisk.off", "fit"},
    {"blobby.off", "fit", "rotor.off", "fit"},
    {"cow.off", "fit", "star.off", "fit"},
    {"camel.off", "fit", "couplingdown.off", "fit"},
    {"head.off", "fit", "blobby-shuffled.off", "fit"},  // faces turned at random
};

class Sign : public testing::TestWithParam<Scene> {};

TEST_P(Sign, AgreesWithCgal) {
  const Scene& scene = GetParam();
  expect_signs(test::load(scene.o1, scene.steps1), test::load(scene.o2, scene.steps2));
}
std::string scene_name(const testing::TestParamInfo<Scene>& info) {
  std::string text = std::string(info.param.o1) + "_in_" + info.param.o2;
  std::ranges::replace_if(
      text, [](unsigned char c) { return !std::isalnum(c); }, '_');
  return text;
}
INSTANTIATE_TEST_SUITE_P(Scenes, Sign, testing::ValuesIn(kScenes), scene_name);

// A ball with a spherical cavity, which holds a smaller ball; a second ball stands beside.
Mesh nested_balls() {
  const Mesh ball = test::sphere(3);
  Mesh mesh = test::joined(ball, test::flipped(test::placed(ball, "scale:0.7")));
  mesh = test::joined(mesh, test::placed(ball, "scale:0.3"));
  return test::joined(mesh, test::placed(ball, "scale:0.5,translate:2:0:0"));
}

TEST(Sign, NestedCavities) {
  expect_signs(test::load("knot2.off", "fit,scale:2.2,translate:0.3:0:0"), nested_balls());
}

TEST(Sign, ComponentsOfAnyOrientation) {
  // Only its position distinguishes the cavity from a ball.
  const Mesh ball = test::sphere(3);
  const Mesh o1 = test::load("knot2.off", "fit,scale:2.2");
  expect_signs(o1, test::joined(ball, test::placed(ball, "scale:0.7")));
  expect_signs(o1, test::joined(test::flipped(ball), test::placed(ball, "scale:0.7")));
}

TEST(Sign, InwardAndLocallyFlippedFaces) {
  const Mesh o1 = test::load("head.off", "fit"), o2 = test::load("elephant.off", "fit");
  expect_signs(o1, test::flipped(o2));
  expect_signs(o1, test::flipped(o2, 7));
}

// The number of points inside, by the sign's method, with either engine.
std::size_t count_inside(const Sites& sites, const std::vector<Vec3>& points) {
  std::size_t count = 0;
  for (const std::string& engine : test::engine_names())
    for (const std::uint8_t in :
         inside_flags(sites, points, closest_points(sites, points, {.engine = make_engine(engine)}),
                      SignMethod::exact))
      count += in;
  return count;
}

// Regression: a sliver's normal is zero or noise, which made its neighbours' pseudonormals wrong.
TEST(Sign, SliversAtSharpEdges) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (const double degrees : {20.0, 60.0, 90.0, 120.0})
    for (const char* steps : {"", "rotate:31:127:201,translate:0.1:0.2:0.3", "rotate:-70:15:8"}) {
      SCOPED_TRACE(degrees);
      const double a = degrees * std::numbers::pi / 360, c = std::cos(a), s = std::sin(a);
      const Mesh wedge = test::wedge(a);
      std::vector<Vec3> outside, within;
      for (int i = 0; i < 500; ++i) {
        const double x = 0.05 + 0.9 * u(random), m = u(random), n = u(random);
        outside.push_back({x, -s * (m + n), c * (m - n)});
        within.push_back({x, c * (0.05 + 0.9 * m), 0.9 * s * (0.05 + 0.9 * m) * (2 * n - 1)});
      }
      const Sites sites(test::placed(wedge, steps));
      ASSERT_EQ(choose_sign(sites, SignMethod::automatic).method, SignMethod::exact);
      EXPECT_EQ(count_inside(sites, test::placed(outside, steps)), 0u);
      EXPECT_EQ(count_inside(sites, test::placed(within, steps)), 1000u);
    }
}

// A shell with a vertex on another shell is not inside it, in either order of the file.
TEST(Sign, TouchingShellsAreSolid) {
  const Mesh big = test::cube(1);
  for (const char* steps : {"scale:0.5,translate:1.5:0:0", "scale:0.5,translate:-1.5:0.2:0",
                            "translate:2:0:0", "scale:0.3,translate:0:0.1:-1.3"}) {
    SCOPED_TRACE(steps);
    const Mesh small = test::placed(test::cube(1), steps);
    const Vec3 middle = 1.05 * centre(bounds(small));  // nearer to its own faces than to the other's
    for (const Mesh& mesh : {test::joined(big, small), test::joined(small, big)})
      EXPECT_EQ(count_inside(Sites(mesh), {middle, {0.1, 0.2, 0.3}, 3.0 * middle}), 4u);
  }
}

// From far away both sides of a wall are equally close in single precision.
TEST(Sign, ThinPlatesAreThinFromFarAway) {
  for (const double thickness : {1e-2, 1e-4, 1e-7})
    for (const double away : {1.0, 10.0, 1e3, 1e6}) {
      Mesh plate = test::cube(1);
      for (Vec3& p : plate.positions) p[2] *= thickness / 2;
      std::vector<Vec3> points;
      points.reserve(100);
      for (int i = 0; i < 100; ++i) points.push_back({0.01 * i - 0.5, 0.3, i % 2 ? away : -away});
      EXPECT_EQ(count_inside(Sites(plate), points), 0u) << thickness << ' ' << away;
    }
}

TEST(Sign, RefitThatTurnsTheMeshInsideOut) {
  Sites sites(test::sphere(2));
  std::vector<Vec3> mirrored = sites.mesh().positions;
  for (Vec3& p : mirrored) p[0] = -p[0];
  sites.refit(mirrored);
  EXPECT_EQ(count_inside(sites, {{0.1, 0.2, 0.3}, {0.9, 0.9, 0.1}}), 2u);
}

TEST(Sign, WindingAgreesOnAClosedMesh) {
  expect_signs(test::load("head.off", "fit"), test::load("elephant.off", "fit"), SignMethod::winding, 128);
  expect_signs(test::load("head.off", "fit"), test::flipped(test::load("elephant.off", "fit")),
               SignMethod::winding, 128);
}

TEST(Sign, OpenMeshIsUnsignedWithAReason) {
  const Surface surface(test::cube(), {.resolution = 32});
  const Sites open(test::load("elephant-with-holes.off", "fit"));
  const DistanceMap map = compute_map(surface, open);
  EXPECT_EQ(map.sign.method, SignMethod::none);
  EXPECT_FALSE(map.sign.reason.empty());
  for (const std::uint32_t t : surface.sample_texels()) ASSERT_GE(map.distance[t], 0);
  EXPECT_THROW((void)compute_map(surface, open, {.sign = SignMethod::exact}), Error);
}

TEST(Sign, NoneIsUnsigned) {
  const Surface surface(test::cube(0.5), {.resolution = 32});
  const DistanceMap map = compute_map(surface, Sites(test::sphere(2)), {.sign = SignMethod::none});
  EXPECT_EQ(map.sign.method, SignMethod::none);
  for (const std::uint32_t t : surface.sample_texels()) ASSERT_GT(map.distance[t], 0);
}

}  // namespace
}  // namespace sdm
