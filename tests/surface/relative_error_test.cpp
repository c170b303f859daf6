#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/sampling_bound.h>
#include <sdm/sdm.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/vec.h"
#include "support/every_case.h"
#include "support/meshes.h"
#include "surface/sampling_bound/sample_tree.h"

namespace sdm {
namespace {

using testing::HasSubstr;

/// The largest distance to the nearest sample that random points of each face have, the same ones at any
/// time.
std::vector<double> seen(const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const surface::SampleTree tree(surface, SamplingBound(surface).value());
  const std::vector<Vec3> points = surface.sample_points();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> radii(mesh.triangles.size());
  for (std::size_t f = 0; f < radii.size(); ++f)
    for (int i = 0; i < 60; ++i) {
      const double s = i % 3 == 0 ? 1 : std::sqrt(unit(random)), t = unit(random);
      const auto& [a, b, c] = mesh.triangles[f];
      const Vec3 p =
          (1 - s) * mesh.positions[a] + (s * (1 - t)) * mesh.positions[b] + (s * t) * mesh.positions[c];
      radii[f] = std::max(radii[f], norm(p - points[tree.nearest(p)]));
    }
  return radii;
}

TEST(RelativeError, BoundsTheMeasuredErrorClosely) {
  std::vector<double> slack;
  for (const char* name : {"head.off", "knot2.off", "elephant-with-holes.off"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = test::load(name);
    Surface surface(mesh, {.resolution = 256});
    SamplingBound bound(surface);
    const RelativeError error(surface, bound);
    const std::vector<double> first = seen(surface);
    const double largest = *std::ranges::max_element(first), size = diagonal(bounds(mesh));
    EXPECT_GE(error.of(bound), 1);
    EXPECT_LE(error.of(bound), 1.5);
    std::vector<double> errors(first.size());
    error.of_faces(bound, errors);
    EXPECT_GE(*std::ranges::min_element(errors), 1);
    const std::vector<float> radii(bound.face_radii().begin(), bound.face_radii().end());
    for (std::size_t frame = 0; frame < 10; frame += test::stride(4)) {
      std::vector<Vec3> positions = mesh.positions;
      for (Vec3& p : positions) {
        const double angle = 0.3 * static_cast<double>(frame) * p[0] / size, c = std::cos(angle),
                     s = std::sin(angle);
        p = {(1 + 0.1 * static_cast<double>(frame)) * p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
      }
      surface.refit(positions);
      bound.refit(surface);
      const std::vector<double> now = seen(surface);
      const double measured = *std::ranges::max_element(now) / largest;
      EXPECT_GE(error.of(bound), measured);
      slack.push_back(error.of(bound) / measured);
      error.of_faces(bound, errors);
      for (std::size_t f = 0; f < now.size(); ++f) ASSERT_GE(errors[f], now[f] / radii[f]) << f;
    }
  }
  std::ranges::sort(slack);
  EXPECT_LE(slack[slack.size() / 2], 1.5);
}

TEST(RelativeError, OfAGrowingPlaneIsItsFactor) {
  Mesh mesh = test::load("cube.off");
  Surface surface(mesh, {.resolution = 128});
  SamplingBound bound(surface);
  const RelativeError error(surface, bound);
  EXPECT_NEAR(error.of(bound), 1, 0.05);
  for (Vec3& p : mesh.positions) p = 3.0 * p;
  surface.refit(mesh.positions);
  bound.refit(surface);
  EXPECT_NEAR(error.of(bound), 3, 0.15);
  std::vector<double> errors(mesh.triangles.size());
  error.of_faces(bound, errors);
  for (const double e : errors) EXPECT_NEAR(e, 3, 0.15);
}

TEST(RelativeError, RejectsBoundsOfAnotherSurface) {
  const Surface cube(test::load("cube.off"), {.resolution = 64}),
      pig(test::load("pig.off"), {.resolution = 64});
  SamplingBound bound(cube);
  const RelativeError error(cube, bound);
  EXPECT_THROW((void)error.of(SamplingBound(pig)), Error);
  const double before = bound.value();
  EXPECT_THROW(bound.refit(pig), Error);
  EXPECT_EQ(bound.value(), before);
}

/// Infinite where the atlas is too small for its charts.
double bound_or_none(const Mesh& mesh, const AtlasOptions& options) try {
  return SamplingBound(Surface(mesh, options)).value();
} catch (const Error&) {
  return std::numeric_limits<double>::infinity();
}

TEST(ResolutionFor, IsAboutTheSmallestSufficient) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles})
    for (const double share : {0.05, 0.01, 0.002}) {
      const Mesh mesh = test::load("elephant-with-holes.off");
      const double precision = share * diagonal(bounds(mesh));
      double done = 0;
      AtlasOptions options{.kind = kind};
      options.progress = [&](std::string_view step, double fraction) {
        EXPECT_EQ(step, "resolution");
        EXPECT_GE(fraction, done);
        done = fraction;
        return true;
      };
      const std::uint32_t resolution = resolution_for(mesh, precision, options);
      options.progress = {};
      options.resolution = resolution;
      const double bound = bound_or_none(mesh, options);
      EXPECT_LE(bound, precision);
      EXPECT_EQ(resolution % 16, 0u);
      EXPECT_LE(done, 1 - std::exp2(-6)) << "more than 6 trials, each of half of what remains";
      options.resolution = resolution - std::max(16u, resolution / 8 / 16 * 16);
      if (bound <= 0.9 * precision) {
        // Layouts differ: the bound falls with the resolution only to a few percent.
        EXPECT_GT(bound_or_none(mesh, options), 0.95 * precision);
      }
    }
}

TEST(ResolutionFor, CoarsePrecisionsUseTheMinimumOfTheCharts) {
  EXPECT_EQ(resolution_for(test::load("cube.off"), 1e6), 16u);
  const std::uint32_t resolution = resolution_for(test::load("bunny.obj"), 1e6);
  EXPECT_GT(resolution, 16u);
  EXPECT_LE(resolution, 512u);
}

TEST(ResolutionFor, TexelSizesArePrecisionsOfHalfTheirDiagonal) {
  const Mesh mesh = test::load("elephant-with-holes.off");
  const double size = 0.02 * diagonal(bounds(mesh));
  AtlasOptions atlas;
  atlas.resolution = resolution_for(mesh, {.texel_size = size}, atlas);
  EXPECT_EQ(atlas.resolution, resolution_for(mesh, size / std::sqrt(2)));
  EXPECT_LE(bound_or_none(mesh, atlas), size / std::sqrt(2));
  EXPECT_EQ(resolution_for(mesh, PrecisionOptions{}, {.resolution = 48}), 48u);
  EXPECT_THROW((void)resolution_for(mesh, {.precision = size, .texel_size = size}, atlas), Error);
}

TEST(ResolutionFor, RejectsUnattainablePrecisions) {
  const Mesh mesh = test::load("cube.off");
  for (const double precision : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)resolution_for(mesh, precision), Error);
  try {
    (void)resolution_for(mesh, 1e-9);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the maximum of 32768 texels per side"));
  }
}

}  // namespace
}  // namespace sdm
