#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/solid.h>

#include <numbers>

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

TEST(SolidVolume, OpenMeshesHaveNone) {
  EXPECT_THROW((void)solid_volume(Sites(test::single_triangle())), Error);
}

}  // namespace
}  // namespace sdm
