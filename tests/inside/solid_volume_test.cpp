#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <ctime>
#include <numbers>
#include <random>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

void expect_exactly(const Mesh& mesh, double volume) {
  const BoundedNumber bounds = solid_volume(Sites(mesh));
  EXPECT_EQ(bounds.certainty, Certainty::exact);
  EXPECT_EQ(bounds.lower, bounds.upper);
  EXPECT_EQ(bounds.value, bounds.lower);
  EXPECT_NEAR(bounds.lower, volume, 1e-12 * volume);
}

void expect_between(const Mesh& mesh, double volume, double width) {
  const BoundedNumber bounds = solid_volume(Sites(mesh));
  EXPECT_LE(bounds.lower, volume * (1 + 1e-12));
  EXPECT_GE(bounds.upper, volume * (1 - 1e-12));
  EXPECT_LE(bounds.upper - bounds.lower, width * volume);
  EXPECT_LE(bounds.lower, bounds.value);
  EXPECT_LE(bounds.value, bounds.upper);
}

TEST(SolidVolume, OfEmbeddedMeshesIsExact) {
  expect_exactly(test::tetrahedron(), 1.0 / 6);
  expect_exactly(test::cube(1), 8);
  Mesh flipped_face = test::cube(1);
  std::swap(flipped_face.triangles[2][0], flipped_face.triangles[2][1]);
  expect_exactly(flipped_face, 8);
}

TEST(SolidVolume, IsInvariantUnderMotionAndOrientation) {
  const Mesh torus = test::torus(20, 13);
  const double volume = solid_volume(Sites(torus)).lower;
  EXPECT_GT(volume, 0);
  for (const Mesh& mesh : {test::moved(torus, {1000, 0, 0}), test::flipped(torus)})
    EXPECT_NEAR(solid_volume(Sites(mesh)).lower, volume, 1e-9 * volume);
}

TEST(SolidVolume, SubtractsCavitiesAndAddsShells) {
  const Mesh cube = test::cube(1);
  expect_exactly(test::joined(cube, test::placed(cube, "scale:0.5")), 8 - 1);
  expect_exactly(test::joined(cube, test::placed(cube, "translate:5:0:0")), 16);
}

// Two cubes of volume 1 and 1/4 that overlap by 1/8.
TEST(SolidVolume, CountsOverlapsOnce) {
  const Mesh cube = test::placed(test::cube(1), "scale:0.5");
  Mesh bar = cube;
  for (Vec3& p : bar.positions) p = {p[0] + 0.5, 0.5 * p[1], 0.5 * p[2]};
  expect_between(test::joined(cube, bar), 1.125, 1e-12);
  expect_between(test::joined(cube, test::placed(cube, "translate:0.5:0.5:0.5")), 2 - 0.125, 1e-12);
  // Their squares have a regular octagon in common; two sides of each lie in the same planes.
  expect_between(test::joined(cube, test::placed(cube, "rotate:45:0:0")), 4 - 2 * std::numbers::sqrt2, 1e-6);
}

// A part that is turned inside out is inside all the same: the bounds hold the integral of |z + 0.4| over a
// sphere.
TEST(SolidVolume, OfAMeshThatPassesThroughItself) {
  Mesh mesh = test::sphere(4);
  for (Vec3& p : mesh.positions) p[0] *= p[2] + 0.4;
  const auto integral = [](double z) { return z * z / 2 - z * z * z * z / 4 + 0.4 * (z - z * z * z / 3); };
  const double volume = std::numbers::pi * (integral(1) - 2 * integral(-0.4) + integral(-1));
  const BoundedNumber bounds = solid_volume(Sites(mesh));
  EXPECT_GT(bounds.upper, 0.99 * volume);  // the sphere is a polyhedron
  EXPECT_LT(bounds.lower, volume);
  EXPECT_LT(bounds.upper - bounds.lower, 1e-6 * volume);
}

// Closed needles that all begin at one place, so that each crosses most of the others.
Mesh needles(std::uint32_t count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return normalized(Vec3{normal(random), normal(random), normal(random)}); };
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t a = 4 * i, b = a + 1, c = a + 2, d = a + 3;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(0.002 * direction());
    mesh.positions.push_back(direction());
    for (const Triangle& t : {Triangle{a, b, c}, {a, d, b}, {b, d, c}, {a, c, d}})
      mesh.triangles.push_back(t);
  }
  return mesh;
}

// By a budget of work, the same with any number of threads: without it, this takes more than a minute.
TEST(SolidVolume, OfManyNeedlesThroughOnePlaceIsBoundedSoon) {
  const Mesh mesh = needles(100);
  double sum = 0;  // of all needles, as if none crossed another one
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto p = [&](std::uint32_t k) { return mesh.positions[4 * i + k] - mesh.positions[4 * i]; };
    sum += std::abs(dot(p(1), cross(p(2), p(3)))) / 6;
  }
  const Sites sites(mesh);
  const std::clock_t start = std::clock();
  const BoundedNumber bounds = solid_volume(sites);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10);
  EXPECT_EQ(bounds.certainty, Certainty::bounded);
  EXPECT_LE(bounds.lower, sum);
  EXPECT_GE(bounds.upper, 0.5 * sum);
  EXPECT_LE(bounds.upper, 4 * sum);
  const ThreadLimit one(1);
  const BoundedNumber again = solid_volume(sites);
  EXPECT_EQ(again.lower, bounds.lower);
  EXPECT_EQ(again.upper, bounds.upper);
}

TEST(SolidVolume, OpenMeshesHaveNone) {
  EXPECT_THROW((void)solid_volume(Sites(test::single_triangle())), Error);
}

}  // namespace
}  // namespace sdm
