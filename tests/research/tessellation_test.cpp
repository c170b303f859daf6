// Distance functions that are drawn as meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include "research/fields/fields.h"
#include "support/error_of.h"
#include "support/oracle.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

constexpr double kRounding = 2e-6;  // of the diagonal

fields::Field drawn(const Sites& sites, const Grid& grid, double error,
                    double band = std::numeric_limits<double>::infinity()) {
  return fields::compute_field(
      sites, grid,
      {.method = fields::Method::brute_force, .max_distance = band, .sites = true, .tessellation = error});
}

TEST(Tessellation, NeverFallsBelowTheDistanceNorExceedsItsError) {
  for (const FieldScene& scene : field_scenes())
    for (const double part : {0.05, 1e-3}) {
      SCOPED_TRACE(scene.name + ", " + std::to_string(part));
      if (scene.mesh.triangles.size() * scene.grid.size() > 5'000'000) continue;  // seconds each
      const double size = diagonal_of(scene), error = part * size;
      const Sites sites(scene.mesh);
      const fields::Field field = drawn(sites, scene.grid, error);
      const fields::Field exact = fields::compute_field(
          sites, scene.grid, {.method = fields::Method::reference, .sign = SignMethod::none});
      EXPECT_EQ(field.sign.method, SignMethod::none);
      EXPECT_GE(field.accuracy, error);
      EXPECT_LE(field.accuracy, error + 1.0001 * kRounding * size);
      double least = 0, most = 0;
      for (std::size_t i = 0; i < field.distance.size(); ++i) {
        ASSERT_FALSE(std::isnan(field.distance[i]));
        least = std::min(least, double{field.distance[i]} - exact.distance[i]);
        most = std::max(most, double{field.distance[i]} - exact.distance[i]);
      }
      EXPECT_GE(least, -kRounding * size);
      EXPECT_LE(most, field.accuracy);
    }
}

// Otherwise nothing would be drawn as a mesh.
TEST(Tessellation, HasAnErrorThatFollowsItsBound) {
  const Mesh mesh = sphere(2);
  const Grid grid = make_grid(around(mesh, 0.5), {24, 25, 26});
  const Sites sites(mesh);
  const fields::Field exact =
      fields::compute_field(sites, grid, {.method = fields::Method::brute_force, .sign = SignMethod::none});
  double before = std::numeric_limits<double>::infinity();
  for (const double error : {0.2, 0.02, 0.002}) {
    const fields::Field field = drawn(sites, grid, error);
    double worst = 0;
    for (std::size_t i = 0; i < grid.size(); ++i)
      worst = std::max(worst, double{field.distance[i]} - exact.distance[i]);
    EXPECT_GT(worst, 0.1 * error);
    EXPECT_LT(worst, 0.5 * before);
    before = worst;
  }
}

TEST(Tessellation, WithinABandMissesOnlyPointsNearItsEnd) {
  const FieldScene scene = field_scenes()[0];
  const double size = diagonal_of(scene), band = 0.1 * size, error = 0.01 * size;
  const Sites sites(scene.mesh);
  const fields::Field field = drawn(sites, scene.grid, error, band);
  const fields::Field exact = fields::compute_field(
      sites, scene.grid, {.method = fields::Method::reference, .sign = SignMethod::none});
  std::size_t values = 0;
  for (std::size_t i = 0; i < field.distance.size(); ++i) {
    if (exact.distance[i] < band - field.accuracy) {
      EXPECT_FALSE(std::isnan(field.distance[i]));
    }
    if (std::isnan(field.distance[i])) continue;
    ++values;
    EXPECT_LE(field.distance[i], band);
    EXPECT_NEAR(field.distance[i], exact.distance[i], field.accuracy);
  }
  EXPECT_GT(values, 100u);
  EXPECT_GT(field.beyond_max_distance, 100u);
}

TEST(Tessellation, NeedsBruteForceAndNoSign) {
  const Sites sites(cube());
  const Grid grid = make_grid({{0, 0, 0}, {1, 1, 1}}, {3, 3, 3});
  const auto error = [&](const fields::Options& options) {
    return error_of([&] { return fields::compute_field(sites, grid, options); });
  };
  const fields::Method brute_force = fields::Method::brute_force;
  EXPECT_THAT(error({.method = fields::Method::difi, .tessellation = 0.1}), HasSubstr("not by difi"));
  EXPECT_THAT(error({.method = brute_force, .tessellation = -1}), HasSubstr("negative"));
  EXPECT_THAT(error({.method = brute_force, .tessellation = std::nan("")}), HasSubstr("negative"));
  EXPECT_THAT(error({.method = brute_force, .sign = SignMethod::exact, .tessellation = 0.1}),
              HasSubstr("no sign"));
  EXPECT_THAT(error({.method = brute_force, .tessellation = 1e-9}), HasSubstr("single precision"));
}

}  // namespace
}  // namespace sdm::test
