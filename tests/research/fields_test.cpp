// All methods find the same field, that of the reference engine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cstring>

#include "research/fields/fields.h"
#include "support/error_of.h"
#include "support/simd_targets.h"
#include "volume/field_checks.h"

namespace sdm::test {
namespace {

using fields::Method;
using fields::MethodInfo;
using ::testing::HasSubstr;

void expect_agreement(const FieldScene& scene, double band) {
  const Sites sites(scene.mesh);
  const DistanceField expected = reference_field(sites, scene.grid, {.max_distance = band});
  for (const MethodInfo& method : fields::methods()) {
    if (method.needs_max_distance && band == kInfinity) continue;
    SCOPED_TRACE(scene.name + ", " + std::string(method.name) + ", band " + std::to_string(band));
    const fields::Field field =
        fields::compute_field(sites, scene.grid, {.method = method.method, .max_distance = band});
    EXPECT_EQ(field.method, method.method);
    EXPECT_LE(field.accuracy, 1.0001 * kFieldTolerance * diagonal_of(scene));
    expect_equal(field, expected, kFieldTolerance * diagonal_of(scene));
  }
}

TEST(FieldMethods, AgreeWithTheReference) {
  for (const FieldScene& scene : field_scenes()) expect_agreement(scene, kInfinity);
}

TEST(FieldMethods, AgreeWithinBands) {
  for (const FieldScene& scene : field_scenes())
    for (const double part : {0.01, 0.1}) expect_agreement(scene, part * diagonal_of(scene));
}

TEST(FieldMethods, AgreeOnEverySetOfInstructions) {
  const FieldScene scene = field_scenes()[0];
  for (const SimdTarget target : simd_targets()) {
    SCOPED_TRACE(name(target));
    const UseSimdTarget use(target);
    expect_agreement(scene, 0.1 * diagonal_of(scene));
  }
}

TEST(FieldMethods, FindSites) {
  for (const FieldScene& scene : field_scenes()) {
    const Sites sites(scene.mesh);
    for (const MethodInfo& method : fields::methods()) {
      SCOPED_TRACE(scene.name + ", " + std::string(method.name));
      expect_sites_at_their_distances(
          fields::compute_field(
              sites, scene.grid,
              {.method = method.method, .max_distance = 0.1 * diagonal_of(scene), .sites = true}),
          sites, kFieldTolerance * diagonal_of(scene));
    }
  }
}

TEST(FieldMethods, TakeTheGeneralisedWindingNumber) {
  const FieldScene scene = field_scenes()[1];
  const Sites sites(scene.mesh);
  expect_equal(
      fields::compute_field(sites, scene.grid, {.method = Method::difi, .sign = SignMethod::winding}),
      reference_field(sites, scene.grid, {.sign = SignMethod::winding}),
      kFieldTolerance * diagonal_of(scene));
}

TEST(FieldMethods, DoNotDependOnTheNumberOfThreads) {
  const FieldScene scene = field_scenes()[0];
  const Sites sites(scene.mesh);
  for (const MethodInfo& method : fields::methods()) {
    SCOPED_TRACE(method.name);
    const fields::Options options{
        .method = method.method, .max_distance = 0.1 * diagonal_of(scene), .sites = true};
    const fields::Field several = fields::compute_field(sites, scene.grid, options);
    const ThreadLimit limit(1);
    const fields::Field one = fields::compute_field(sites, scene.grid, options);
    EXPECT_EQ(std::memcmp(one.distance.data(), several.distance.data(), 4 * one.distance.size()), 0);
    EXPECT_EQ(one.site, several.site);
    EXPECT_EQ(one.work.pairs_culled, several.work.pairs_culled);
    EXPECT_EQ(one.work.evaluations, several.work.evaluations);
  }
}

TEST(FieldMethods, OfWrongOptionsAreErrors) {
  const Sites sites(cube());
  const Grid grid = make_grid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2});
  const auto error = [&](const fields::Options& options) {
    return error_of([&] { return fields::compute_field(sites, grid, options); });
  };
  EXPECT_THAT(error({.method = Method::difi, .max_distance = 0}), HasSubstr("max_distance is 0"));
  EXPECT_THAT(error({.method = Method::csc}), HasSubstr("needs a maximum distance"));
  EXPECT_THAT(error({.method = static_cast<Method>(99)}), HasSubstr("unknown method"));
}

TEST(FieldMethods, ThatExceedTheMemoryAreErrors) {
  const Sites sites(cube());
  const std::array<std::uint32_t, 3> most{Grid::kMostPoints, Grid::kMostPoints, Grid::kMostPoints};
  const Grid grid = make_grid({{0, 0, 0}, {1, 1, 1}}, most);
  for (const MethodInfo& method : fields::methods())
    EXPECT_NE(error_of([&] {
                return fields::compute_field(sites, grid,
                                             {.method = method.method, .max_distance = 1, .sites = true});
              }),
              "");
}

TEST(FieldMethods, TooFarForSinglePrecisionAreErrorsOfSlices) {
  const Grid grid = make_grid({{1e20, 0, 0}, {2e20, 1e20, 1e20}}, {2, 2, 2});
  EXPECT_THAT(error_of([&] { return fields::compute_field(Sites(cube()), grid, {.method = Method::difi}); }),
              HasSubstr("use best"));
}

TEST(FieldMethods, CanBeCancelled) {
  const Sites sites(sphere(2));
  const Grid grid = make_grid({{-1, -1, -1}, {1, 1, 1}}, {24, 24, 24});
  for (const MethodInfo& method : fields::methods()) {
    SCOPED_TRACE(method.name);
    fields::Options options{.method = method.method, .max_distance = 1};
    std::vector<double> seen;
    options.progress = [&](std::string_view, double fraction) {
      seen.push_back(fraction);
      return true;
    };
    (void)fields::compute_field(sites, grid, options);
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(seen.back(), 1);
    options.progress = [](std::string_view, double) { return false; };
    EXPECT_THROW((void)fields::compute_field(sites, grid, options), Cancelled);
  }
}

TEST(FieldMethods, CountTheirWork) {
  const FieldScene scene = field_scenes()[0];
  const Sites sites(scene.mesh);
  const auto drawn = [&](Method method) {
    return fields::compute_field(sites, scene.grid, {.method = method});
  };
  const fields::Field brute = drawn(Method::brute_force), difi = drawn(Method::difi),
                      linear = drawn(Method::linear_factorization);
  EXPECT_EQ(brute.work.pairs, brute.work.sites * scene.grid.dims[2]);
  EXPECT_EQ(brute.work.pairs_culled, 0u);
  for (const fields::Field* field : {&brute, &difi, &linear}) {
    EXPECT_EQ(field->work.sites, brute.work.sites);
    EXPECT_LE(field->work.pairs_culled + field->work.pairs_empty, field->work.pairs);
    EXPECT_EQ(field->report.field_bytes, 4 * scene.grid.size());
    EXPECT_GT(field->report.working_bytes, 0u);
    EXPECT_GE(field->work.evaluations, scene.grid.size()) << "every point has a site";
  }
  EXPECT_LT(difi.work.evaluations, brute.work.evaluations);
  EXPECT_LT(linear.work.evaluations, difi.work.evaluations);
}

}  // namespace
}  // namespace sdm::test
