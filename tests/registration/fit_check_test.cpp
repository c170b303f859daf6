// Mirrored and scaled parts are recognised, and others are not.
#include <gmock/gmock.h>
#include <sdm/doubts.h>

#include <cmath>
#include <random>

#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;

/// A block with a ring on one side, its mirror image is another part.
Mesh handed() {
  Mesh block = cube(1);
  for (Vec3& p : block.positions) p = {3 * p[0], 1.5 * p[1], p[2]};
  return joined(joined(block, ring(24, 1.2, {1.5, 0.2, 1.1})), ring(20, 0.5, {-2.5, 1.4, 0.3}));
}

Mesh mapped(Mesh mesh, const Transform& map) {
  transform(mesh, map);
  return mesh;
}

Transform mirror_at_x() {
  Transform map;
  map.rows[0][0] = -1;
  return map;
}

Transform displaced(const Mesh& mesh) {
  const double size = diagonal(bounds(mesh));
  return Transform::translation({0.01 * size, -0.02 * size, 0.01 * size}) * Transform::rotation({1, -1.5, 2});
}

Mesh noisy(Mesh mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, share * diagonal(bounds(mesh)));
  for (Vec3& p : mesh.positions)
    for (double& x : p) x += noise(random);
  return mesh;
}

TEST(FindMirrored, FindsTheOtherHand) {
  for (const Mesh& mesh : {handed(), load("elephant.off")}) {
    const Sites sites(mesh);
    const Mesh other = noisy(mapped(mapped(mesh, mirror_at_x()), displaced(mesh)), 2e-4, 1);
    const Alignment found = align(other, sites);
    const std::optional<MirroredFit> fit = find_mirrored(other, sites, found);
    if (found.after.rms < 0.005 * found.gyration_radius) continue;  // it fits
    ASSERT_TRUE(fit) << mesh.triangles.size() << " " << found.after.rms / found.gyration_radius;
    EXPECT_LT(fit->misfit, 0.25 * fit->misfit_as_given);
    const std::vector<Doubt> doubts = doubts_of(found, {}, fit);
    ASSERT_FALSE(doubts.empty());
    EXPECT_EQ(doubts[0].reason, DoubtReason::mirrored);
    EXPECT_THAT(doubts[0].text, ::testing::HasSubstr("mirrored"));
  }
  EXPECT_GT(align(mapped(handed(), mirror_at_x()), Sites(handed())).after.rms, 0.01);
}

TEST(FindMirrored, IsNotMisledByOthers) {
  const Mesh mesh = handed();
  const Sites sites(mesh);
  const auto mirrored = [&](const Mesh& o1) {
    return find_mirrored(o1, sites, align(o1, sites)).has_value();
  };
  EXPECT_FALSE(mirrored(mapped(mesh, displaced(mesh))));
  EXPECT_FALSE(mirrored(noisy(mesh, 0.005, 2)));
  // Far from its place: it does not fit, and neither does its mirror image fit better than itself, turned.
  EXPECT_FALSE(mirrored(mapped(mesh, Transform::rotation({0, 90, 0}))));
  EXPECT_FALSE(mirrored(mapped(mesh, Transform::rotation({170, 20, 0}))));
  EXPECT_FALSE(mirrored(mapped(cube(1), Transform::scaling(1.5))));
  const Mesh symmetric = torus(24, 12);
  const Sites to(symmetric);
  const Mesh turned = mapped(symmetric, Transform::rotation({80, 10, 0}));
  EXPECT_FALSE(find_mirrored(turned, to, align(turned, to)).has_value());
}

TEST(FindMirrored, OfPoints) {
  const Mesh mesh = handed();
  const Sites sites(mesh);
  std::mt19937 random(3);
  const std::vector<Vec3> points = random_surface_points(mapped(mesh, mirror_at_x()), 5000, random);
  EXPECT_TRUE(find_mirrored(points, {}, sites, align(points, {}, sites)).has_value());
}

TEST(FindScale, FindsTheFactor) {
  const Mesh mesh = handed();
  const Sites sites(mesh);
  for (const double shrunk : {0.93, 0.98, 0.998, 1.004, 1.05})
    for (const double noise : {0.0, 2e-4}) {
      const Mesh o1 = mapped(noisy(mapped(mesh, Transform::scaling(shrunk)), noise, 4), displaced(mesh));
      const std::optional<OtherScale> scale = find_scale(o1, sites, align(o1, sites));
      ASSERT_TRUE(scale) << shrunk << " " << noise;
      // The noise of the few vertices is not independent from sample to sample.
      EXPECT_NEAR(scale->factor * shrunk, 1, noise > 0 ? 2e-3 : 1e-6) << noise;
      EXPECT_LT(scale->residual, 0.75 * scale->residual_as_given);
      EXPECT_GE(scale->standard_error, 0);
    }
}

TEST(FindScale, CoversTheTruthWithItsStandardErrors) {
  const Mesh mesh = load("elephant.off");
  const Sites sites(mesh);
  int beyond = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Mesh o1 = noisy(mapped(mesh, Transform::scaling(0.98)), 1e-3, seed);
    const std::optional<OtherScale> scale = find_scale(o1, sites, align(o1, sites));
    ASSERT_TRUE(scale);
    beyond += std::abs(scale->factor * 0.98 - 1) > 3 * scale->standard_error;
  }
  EXPECT_LE(beyond, 2);
}

TEST(FindScale, IsNothingWhereItIsNot) {
  const Mesh mesh = handed();
  const Sites sites(mesh);
  const auto scaled = [&](const Mesh& o1, const AlignOptions& options = {}) {
    return find_scale(o1, sites, align(o1, sites, options)).has_value();
  };
  EXPECT_FALSE(scaled(mesh));
  EXPECT_FALSE(scaled(mapped(mesh, displaced(mesh))));
  for (unsigned seed = 0; seed < 5; ++seed) EXPECT_FALSE(scaled(noisy(mesh, 1e-3, seed))) << seed;
  EXPECT_FALSE(scaled(mapped(mesh, Transform::scaling(3))));
  EXPECT_FALSE(
      scaled(mapped(mesh, Transform::scaling(0.98)), {.freedoms = {.rotations = {true, true, false}}}));
  const Mesh flat = square(2, 0);
  const Sites to(flat);
  const Mesh small = mapped(flat, Transform::scaling(0.98));
  EXPECT_FALSE(find_scale(small, to, align(small, to)).has_value());
}

}  // namespace
}  // namespace sdm
