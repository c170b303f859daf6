// The sampling bound against the nearest samples of random points of the surface.

#include <gtest/gtest.h>
#include <sdm/sampling_bound.h>
#include <sdm/sdm.h>
#include <sdm/sites.h>

#include <cmath>
#include <random>
#include <vector>

#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

/// The largest distance from random points of the surface, corners of faces included, to their nearest
/// sample.
double measured(const Surface& surface, std::size_t count) {
  std::mt19937 random(8);
  const Mesh& mesh = surface.mesh();
  std::vector<Vec3> points = test::random_surface_points(mesh, count, random);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 1 + mesh.triangles.size() / count)
    for (const std::uint32_t v : mesh.triangles[i]) points.push_back(mesh.positions[v]);

  // Samples in a k-d tree: median splits of an implicit balanced tree.
  std::vector<Vec3> samples = surface.sample_points();
  const auto build = [&](const auto& self, std::size_t begin, std::size_t end, int axis) -> void {
    if (end - begin < 2) return;
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(samples.begin() + begin, samples.begin() + middle, samples.begin() + end,
                     [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
    self(self, begin, middle, (axis + 1) % 3);
    self(self, middle + 1, end, (axis + 1) % 3);
  };
  build(build, 0, samples.size(), 0);
  const auto nearest = [&](const auto& self, const Vec3& p, std::size_t begin, std::size_t end, int axis,
                           double best) -> double {
    if (begin == end) return best;
    const std::size_t middle = (begin + end) / 2;
    best = std::min(best, norm(samples[middle] - p));
    const double side = p[axis] - samples[middle][axis];
    const int next = (axis + 1) % 3;
    best = side < 0 ? self(self, p, begin, middle, next, best) : self(self, p, middle + 1, end, next, best);
    if (std::abs(side) < best)
      best = side < 0 ? self(self, p, middle + 1, end, next, best) : self(self, p, begin, middle, next, best);
    return best;
  };
  const auto distances = test::evaluate(
      [&](const Vec3& p) {
        return nearest(nearest, p, 0, samples.size(), 0, std::numeric_limits<double>::infinity());
      },
      points);
  return *std::ranges::max_element(distances);
}

/// The bound must hold, and be at most `slack` times the measured value.
void expect_bound(const Surface& surface, double slack, std::size_t points = 200000) {
  const double seen = measured(surface, points), bound = SamplingBound(surface).value();
  EXPECT_LE(seen, bound);
  EXPECT_LE(bound, slack * seen);
  EXPECT_NEAR(covering_radius(surface), bound, 1e-5 * bound);  // its pieces are rounded to float
}

TEST(SamplingBound, IsValidAndTightOnGoodMeshes) {
  for (const char* name : {"bunny.obj", "head.off", "knot2.off", "elephant-with-holes.off"}) {
    SCOPED_TRACE(name);
    expect_bound(Surface(test::load(name, "fit"), {.resolution = 512}), 2);
  }
  for (const char* name : {"head.off", "knot1.off"}) {
    SCOPED_TRACE(name);
    expect_bound(Surface(test::load(name, "fit"), {.kind = AtlasKind::triangles, .resolution = 1024}), 2);
  }
}

TEST(SamplingBound, LargeFaces) {
  expect_bound(Surface(test::cube(), {.resolution = 256}), 2);
  expect_bound(Surface(test::cube(), {.kind = AtlasKind::triangles, .resolution = 64}), 2);
}

// Texels eight times as long one way as the other, and faces smaller than these.
TEST(SamplingBound, TexelsThatAreNotSquare) {
  for (const char* name : {"cow.off", "knot2.off"})
    for (const auto& [columns, rows] : {std::pair(1024u, 128u), std::pair(128u, 1024u)}) {
      SCOPED_TRACE(name);
      const AtlasOptions options{.kind = AtlasKind::uv, .resolution = columns, .rows = rows};
      expect_bound(Surface(test::with_own_uvs(test::load(name, "fit")), options), 4);
    }
}

TEST(SamplingBound, FacesSmallerThanTexels) {
  expect_bound(Surface(test::load("armadillo.off", "fit"), {.resolution = 256}), 4);
  expect_bound(Surface(test::load("knot2.off", "fit"), {.resolution = 64}), 4);
}

TEST(SamplingBound, SliversAndFacesWithoutArea) {
  for (const char* name :
       {"cylinder_locally_refined.off", "degtri_sliding.off", "boeing.off", "ALSTOM_TEST4.off"}) {
    SCOPED_TRACE(name);
    expect_bound(Surface(test::load(name, "fit"), {.resolution = 256}), 4);
  }
}

// Tiny components without samples, and a protruding degenerate face: their points count too.
TEST(SamplingBound, PartsWithoutSamples) {
  Mesh mesh = test::joined(test::cube(), test::placed(test::cube(), "scale:1e-5,translate:3:0:0"));
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 1}, {0, 0, 3}, {0, 0, 5}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const Surface surface(mesh, {.resolution = 64});
  double farthest = 0;
  for (const Vec3& p : mesh.positions) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& s : surface.sample_points()) nearest = std::min(nearest, norm(s - p));
    farthest = std::max(farthest, nearest);
  }
  EXPECT_GT(farthest, 3.5);
  const SamplingBound bound(surface);
  EXPECT_LE(farthest, bound.value());
  EXPECT_LE(bound.value(), 1.1 * farthest);
  EXPECT_NEAR(covering_radius(surface), bound.value(), 1e-6 * bound.value());
}

TEST(SamplingBound, HoldsAfterAMotion) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Mesh mesh = test::load("cow.off", "fit");
  for (const double motion : {0.0, 0.003, 0.05}) {
    Surface surface(mesh, {.resolution = 128});
    SamplingBound bound(surface);
    const double expected = bound.value_after(motion);
    EXPECT_GE(expected, bound.value());
    std::vector<Vec3> moved = mesh.positions;
    for (Vec3& p : moved)
      p = p + motion * normalized(Vec3{uniform(random), uniform(random), uniform(random)});
    surface.refit(moved);
    EXPECT_LE(measured(surface, 20000), expected);
    bound.refit(surface);
    EXPECT_LE(bound.value(), expected);
    if (motion == 0.05) {
      EXPECT_GT(bound.value(), 1.5 * (expected - 2 * motion));  // it does grow
    }
  }
}

TEST(SamplingBound, HalvesWithTheResolution) {
  const Mesh mesh = test::load("head.off", "fit");
  const double coarse = SamplingBound(Surface(mesh, {.resolution = 256})).value(),
               fine = SamplingBound(Surface(mesh, {.resolution = 1024})).value();
  EXPECT_NEAR(coarse / fine, 4, 1.5);
}

TEST(SamplingBound, DoesNotDependOnTheNumberOfThreads) {
  const Mesh mesh = test::load("head.off", "fit");
  const double many = SamplingBound(Surface(mesh, {.resolution = 256})).value();
  const double radius = covering_radius(Surface(mesh, {.resolution = 256}));
  const ThreadLimit one(1);
  EXPECT_EQ(covering_radius(Surface(mesh, {.resolution = 256})), radius);
  EXPECT_EQ(SamplingBound(Surface(mesh, {.resolution = 256})).value(), many);
}

}  // namespace
}  // namespace sdm
