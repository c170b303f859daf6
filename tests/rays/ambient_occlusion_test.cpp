// Ambient occlusion against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "rays/hemisphere_rays.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm {
namespace {

/// The form factor from a horizontal element to the rectangle [0, x] × [0, y] at height 1 above it.
double corner_factor(double x, double y) {
  const double p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * std::numbers::pi);
}

/// The part of the cosine-weighted hemisphere of (x, y, 0) that a square(side, height) leaves free.
double visible_below_square(const Vec3& p, double side, double height) {
  const double half = side / 2;
  const double x0 = (-half - p[0]) / height, x1 = (half - p[0]) / height;
  const double y0 = (-half - p[1]) / height, y1 = (half - p[1]) / height;
  return 1 - (corner_factor(x1, y1) - corner_factor(x0, y1) - corner_factor(x1, y0) + corner_factor(x0, y0));
}

struct Scene {
  Surface surface;
  Sites sites;
  DistanceMap map;

  Scene(Mesh o1, Mesh o2, std::uint32_t resolution)
      : surface(std::move(o1), {.resolution = resolution}),
        sites(std::move(o2)),
        map(compute_map(surface, sites)) {}
  [[nodiscard]] std::vector<float> occlusion(const AmbientOcclusionOptions& options) const {
    return ambient_occlusion(surface, sites, map, options);
  }
};

TEST(AmbientOcclusion, BelowASquareIsItsFormFactor) {
  const Scene scene(test::square(3, 0), test::square(2, 0.7), 32);
  const std::vector<float> result = scene.occlusion({.rays = 4096});
  double bias = 0;
  for (const std::uint32_t texel : test::owned_texels(scene.surface)) {
    const double expected = visible_below_square(scene.surface.texel_point(texel), 2, 0.7);
    ASSERT_NEAR(result[texel], expected, 0.01);
    bias += result[texel] - expected;
  }
  EXPECT_NEAR(bias / static_cast<double>(scene.surface.owned_texels()), 0, 2e-4);
}

// A few stratified rays for each of many texels are unbiased, too.
TEST(AmbientOcclusion, OfFewRaysHasNoBias) {
  const Scene scene(test::square(3, 0), test::square(2, 0.7), 128);
  for (const std::uint32_t rays : {1u, 5u, 16u}) {
    double bias = 0;
    const std::vector<float> result = scene.occlusion({.rays = rays, .seed = 3});
    for (const std::uint32_t texel : test::owned_texels(scene.surface))
      bias += result[texel] - visible_below_square(scene.surface.texel_point(texel), 2, 0.7);
    EXPECT_NEAR(bias / static_cast<double>(scene.surface.owned_texels()), 0, 0.015) << rays;
  }
}

TEST(AmbientOcclusion, OfTheBackIsNone) {
  const Scene scene(test::flipped(test::square(3, 0)), test::square(2, 0.7), 16);
  for (const std::uint32_t texel : test::owned_texels(scene.surface))
    EXPECT_EQ(scene.occlusion({.rays = 64})[texel], 1);
}

TEST(AmbientOcclusion, InAClosedMeshIsComplete) {
  const Scene scene(test::sphere(2), test::moved(test::cube(3), {0.5, 0.2, 0}), 64);
  const std::vector<float> result = scene.occlusion({.rays = 100});
  for (std::size_t texel = 0; texel < result.size(); ++texel) {
    if (scene.surface.map_faces()[texel] == kNone)
      EXPECT_TRUE(std::isnan(result[texel]));
    else
      ASSERT_EQ(result[texel], 0);
  }
}

TEST(AmbientOcclusion, EndsAtTheLargestDistance) {
  const Scene scene(test::square(1, 0), test::square(40, 0.5), 32);
  // The square is met within R by directions whose cosine exceeds 0.5 / R: a fraction 1 − (0.5 / R)² of them.
  for (const double most : {0.49, 0.6, 1.0}) {
    const std::vector<float> result = scene.occlusion({.rays = 1024, .max_distance = most});
    const double expected = most < 0.5 ? 1 : 0.25 / (most * most);
    for (const std::uint32_t texel : test::owned_texels(scene.surface))
      ASSERT_NEAR(result[texel], expected, 2e-3);
  }
}

// The map only saves work: one without values, from which nothing is known, gives the same bits.
TEST(AmbientOcclusion, DoesNotDependOnTheMap) {
  for (const char* steps : {"fit,translate:0.6:0:0", "fit,translate:0.3:0.1:0"}) {
    SCOPED_TRACE(steps);
    const Scene scene(test::load("elephant.off", "fit"), test::load("knot1.off", steps), 128);
    DistanceMap nothing = scene.map;
    std::ranges::fill(nothing.distance, std::numeric_limits<float>::quiet_NaN());
    for (const double most : {0.05, 0.4, std::numeric_limits<double>::infinity()}) {
      const AmbientOcclusionOptions options{.rays = 16, .max_distance = most, .seed = 7};
      const std::vector<float> with = scene.occlusion(options),
                               without = ambient_occlusion(scene.surface, scene.sites, nothing, options);
      std::size_t partly = 0;
      for (const std::uint32_t texel : test::owned_texels(scene.surface)) {
        ASSERT_EQ(with[texel], without[texel]) << texel;
        partly += with[texel] < 1;
      }
      EXPECT_GT(partly, most < 0.1 ? 0u : 100u) << most;
    }
  }
}

TEST(AmbientOcclusion, IsThatOfTheRays) {
  const Scene scene(test::sphere(2), test::moved(test::sphere(2), {1.5, 0, 0}), 32);
  const std::vector<float> result = scene.occlusion({.rays = 8, .seed = 5});
  for (const std::uint32_t texel : test::owned_texels(scene.surface)) {
    const auto& [a, b, c] = scene.surface.mesh().triangles[scene.surface.map_faces()[texel]];
    const std::vector<Vec3>& p = scene.surface.mesh().positions;
    std::vector<Vec3> directions(8);
    rays::cosine_hemisphere(normalized(cross(p[b] - p[a], p[c] - p[a])), 5, texel, directions);
    std::vector<Ray> rays;
    for (const Vec3& d : directions) rays.push_back({scene.surface.texel_point(texel), d});
    const std::vector<std::uint8_t> met = occluded(scene.sites, rays);
    const auto count = static_cast<double>(std::ranges::count(met, 1));
    EXPECT_EQ(result[texel], static_cast<float>(1 - count / 8));
  }
}

TEST(AmbientOcclusion, DirectionsAreStratified) {
  for (const Vec3& normal : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0.6, -0.8, 0}, normalized({1, 2, -3})}) {
    std::vector<Vec3> directions(256);
    rays::cosine_hemisphere(normal, 1, 2, directions);
    std::vector<int> rings(256), halves(2);
    const Vec3 across = normalized(cross(normal, {3, 1, 2}));
    for (const Vec3& d : directions) {
      EXPECT_NEAR(norm(d), 1, 1e-12);
      const double cosine = dot(d, normal);
      EXPECT_GE(cosine, -1e-15);
      ++rings[std::min<std::size_t>(255, static_cast<std::size_t>(256 * (1 - cosine * cosine)))];
      ++halves[dot(d, across) > 0];
    }
    for (std::size_t i = 1; i < 255; ++i) EXPECT_NEAR(rings[i], 1, 1);
    EXPECT_NEAR(halves[0], 128, 3);
  }
}

TEST(AmbientOcclusion, IsTheSameForAnyNumberOfThreads) {
  const Scene scene(test::sphere(2), test::moved(test::sphere(2), {1.5, 0, 0}), 64);
  const AmbientOcclusionOptions options{.rays = 20};
  const std::vector<float> all = scene.occlusion(options);
  const ThreadLimit one(1);
  const std::vector<float> alone = scene.occlusion(options);
  for (const std::uint32_t texel : test::owned_texels(scene.surface)) ASSERT_EQ(all[texel], alone[texel]);
  EXPECT_NE(all, scene.occlusion({.rays = 20, .seed = 1}));
}

TEST(AmbientOcclusion, Errors) {
  const Scene scene(test::sphere(1), test::cube(), 32);
  using testing::HasSubstr;
  const auto error = [&](const AmbientOcclusionOptions& options) {
    return test::error_of([&] { return scene.occlusion(options); });
  };
  EXPECT_THAT(error({.rays = 0}), HasSubstr("rays is 0: it must be a whole number from 1 to 65536"));
  EXPECT_THAT(error({.rays = 70000}), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(error({.max_distance = 0}), HasSubstr("max_distance"));
  EXPECT_THAT(error({.max_distance = std::nan("")}), HasSubstr("max_distance"));
  const Surface other(test::sphere(1), {.resolution = 64});
  EXPECT_THAT(test::error_of([&] { return ambient_occlusion(other, scene.sites, scene.map); }),
              HasSubstr("resolutions differ"));
  EXPECT_THAT(test::error_of([&] { return free_distances(other, scene.sites, scene.map); }),
              HasSubstr("resolutions differ"));
  EXPECT_THROW((void)scene.occlusion({.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

}  // namespace
}  // namespace sdm
