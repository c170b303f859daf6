// Fields are those of the reference engine, which agree with brute force.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cstring>

#include "support/oracle.h"
#include "support/simd_targets.h"
#include "volume/field_checks.h"

namespace sdm::test {
namespace {

void expect_agreement(const FieldScene& scene, const FieldOptions& options) {
  SCOPED_TRACE(scene.name + ", band " + std::to_string(options.max_distance));
  const Sites sites(scene.mesh);
  const double tolerance = kFieldTolerance * diagonal_of(scene);
  const DistanceField field = compute_field(sites, scene.grid, options);
  EXPECT_LE(field.accuracy, tolerance);
  expect_equal(field, reference_field(sites, scene.grid, options), tolerance);
}

TEST(FieldAgreement, WithoutABand) {
  for (const FieldScene& scene : field_scenes()) expect_agreement(scene, {});
}

TEST(FieldAgreement, WithinBands) {
  for (const FieldScene& scene : field_scenes())
    for (const double part : {0.01, 0.1})
      expect_agreement(scene, {.max_distance = part * diagonal_of(scene)});
}

TEST(FieldAgreement, OnEverySetOfInstructions) {
  const FieldScene scene = field_scenes()[0];
  for (const SimdTarget target : simd_targets()) {
    SCOPED_TRACE(name(target));
    const UseSimdTarget use(target);
    expect_agreement(scene, {.max_distance = 0.1 * diagonal_of(scene)});
  }
}

TEST(FieldAgreement, OfReferenceWithBruteForce) {
  for (const FieldScene& scene : field_scenes()) {
    SCOPED_TRACE(scene.name);
    const DistanceField field = reference_field(Sites(scene.mesh), scene.grid);
    for_some_points(scene.grid, 50, [&](std::size_t i, const Vec3& p) {
      EXPECT_NEAR(std::abs(field.distance[i]), oracle::brute_force(scene.mesh, p), 1e-7 * diagonal_of(scene));
    });
  }
}

TEST(FieldAgreement, OfSignsWithWindingNumbers) {
  for (const FieldScene& scene : field_scenes()) {
    if (!inspect(scene.mesh).oriented || !inspect(scene.mesh).closed) continue;
    SCOPED_TRACE(scene.name);
    const DistanceField field = compute_field(Sites(scene.mesh), scene.grid);
    ASSERT_EQ(field.sign.method, SignMethod::exact);
    for_some_points(scene.grid, 50, [&](std::size_t i, const Vec3& p) {
      if (std::abs(field.distance[i]) > kFieldTolerance * diagonal_of(scene)) {
        EXPECT_EQ(field.distance[i] < 0, oracle::winding_number(scene.mesh, p) != 0);
      }
    });
  }
}

TEST(FieldAgreement, OfSites) {
  for (const FieldScene& scene : field_scenes()) {
    SCOPED_TRACE(scene.name);
    const Sites sites(scene.mesh);
    expect_sites_at_their_distances(
        compute_field(sites, scene.grid, {.max_distance = 0.1 * diagonal_of(scene), .sites = true}), sites,
        kFieldTolerance * diagonal_of(scene));
  }
}

TEST(FieldAgreement, WithTheGeneralisedWindingNumber) {
  const FieldScene scene = field_scenes()[1];
  const DistanceField field = compute_field(Sites(scene.mesh), scene.grid, {.sign = SignMethod::winding});
  ASSERT_TRUE(std::ranges::any_of(field.distance, [](float d) { return d < 0; }));
  expect_agreement(scene, {.sign = SignMethod::winding});
}

TEST(FieldAgreement, OfAnyNumberOfThreads) {
  const FieldScene scene = field_scenes()[0];
  const Sites sites(scene.mesh);
  const FieldOptions options{.max_distance = 0.1 * diagonal_of(scene), .sites = true};
  const DistanceField several = compute_field(sites, scene.grid, options);
  const ThreadLimit limit(1);
  const DistanceField one = compute_field(sites, scene.grid, options);
  EXPECT_EQ(std::memcmp(one.distance.data(), several.distance.data(), 4 * one.distance.size()), 0);
  EXPECT_EQ(one.site, several.site);
}

}  // namespace
}  // namespace sdm::test
