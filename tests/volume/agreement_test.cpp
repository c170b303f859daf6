// All methods find the same field, which that of the reference engine is, and that agrees with brute force.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cstring>

#include "support/oracle.h"
#include "support/simd_targets.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

constexpr double kTolerance = 2e-6;  // of the diagonal

// A point at the border of the band may have a value or not, one on the surface may have either sign.
void expect_equal(const DistanceField& field, const DistanceField& expected, double tolerance) {
  ASSERT_EQ(field.distance.size(), expected.distance.size());
  const auto is_border = [&](float d) { return std::abs(std::abs(d) - field.band) <= tolerance; };
  double worst = 0;
  std::size_t missing = 0, wrong_signs = 0;
  for (std::size_t i = 0; i < field.distance.size(); ++i) {
    const float d = field.distance[i], e = expected.distance[i];
    if (std::isnan(d) || std::isnan(e)) {
      missing += std::isnan(d) != std::isnan(e) && !is_border(std::isnan(d) ? e : d);
    } else {
      worst = std::max(worst, double{std::abs(std::abs(d) - std::abs(e))});
      wrong_signs += std::abs(e) > tolerance && (d < 0) != (e < 0);
    }
  }
  EXPECT_LE(worst, tolerance);
  EXPECT_EQ(missing, 0u);
  EXPECT_EQ(wrong_signs, 0u);
}

void expect_agreement(const FieldScene& scene, double band) {
  const Sites sites(scene.mesh);
  const DistanceField expected =
      compute_field(sites, scene.grid, {.method = FieldMethod::reference, .band = band});
  for (const FieldMethodInfo& method : field_methods()) {
    if (method.needs_band && band == std::numeric_limits<double>::infinity()) continue;
    SCOPED_TRACE(scene.name + ", " + std::string(method.name) + ", band " + std::to_string(band));
    const DistanceField field = compute_field(sites, scene.grid, {.method = method.method, .band = band});
    EXPECT_LE(field.accuracy, 1.0001 * kTolerance * diagonal_of(scene));
    expect_equal(field, expected, kTolerance * diagonal_of(scene));
  }
}

TEST(FieldAgreement, OfAllMethods) {
  for (const FieldScene& scene : field_scenes())
    expect_agreement(scene, std::numeric_limits<double>::infinity());
}

TEST(FieldAgreement, WithinBands) {
  for (const FieldScene& scene : field_scenes())
    for (const double part : {0.01, 0.1}) expect_agreement(scene, part * diagonal_of(scene));
}

TEST(FieldAgreement, OnEverySetOfInstructions) {
  const std::vector<FieldScene> scenes = field_scenes();
  for (const SimdTarget target : simd_targets()) {
    SCOPED_TRACE(name(target));
    const UseSimdTarget use(target);
    expect_agreement(scenes[0], 0.1 * diagonal_of(scenes[0]));
  }
}

TEST(FieldAgreement, OfReferenceWithBruteForce) {
  for (const FieldScene& scene : field_scenes()) {
    SCOPED_TRACE(scene.name);
    const DistanceField field =
        compute_field(Sites(scene.mesh), scene.grid, {.method = FieldMethod::reference});
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
      if (std::abs(field.distance[i]) > kTolerance * diagonal_of(scene)) {
        EXPECT_EQ(field.distance[i] < 0, oracle::winding_number(scene.mesh, p) != 0);
      }
    });
  }
}

double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& p) {
  const std::vector<Vec3>& at = sites.mesh().positions;
  if (type == SiteType::vertex) return norm(at[site] - p);
  if (type == SiteType::edge)
    return oracle::distance(p, at[sites.edges()[site][0]], at[sites.edges()[site][1]]);
  const Triangle& t = sites.mesh().triangles[site];
  return oracle::distance(p, at[t[0]], at[t[1]], at[t[2]]);
}

TEST(FieldAgreement, OfSites) {
  for (const FieldScene& scene : field_scenes()) {
    const Sites sites(scene.mesh);
    for (const FieldMethodInfo& method : field_methods()) {
      SCOPED_TRACE(scene.name + ", " + std::string(method.name));
      const double band = 0.1 * diagonal_of(scene);
      const DistanceField field =
          compute_field(sites, scene.grid, {.method = method.method, .band = band, .sites = true});
      ASSERT_EQ(field.site.size(), scene.grid.size());
      for_some_points(scene.grid, 100, [&](std::size_t i, const Vec3& p) {
        if (std::isnan(field.distance[i])) {
          EXPECT_EQ(field.site_type[i], SiteType::none);
          EXPECT_EQ(field.site[i], kNone);
        } else {
          EXPECT_NEAR(distance_to_site(sites, field.site_type[i], field.site[i], p),
                      std::abs(field.distance[i]), kTolerance * diagonal_of(scene));
        }
      });
    }
  }
}

TEST(FieldAgreement, WithTheGeneralisedWindingNumber) {
  const FieldScene scene = field_scenes()[1];
  const Sites sites(scene.mesh);
  const FieldOptions reference{.method = FieldMethod::reference, .sign = SignMethod::winding};
  const DistanceField expected = compute_field(sites, scene.grid, reference);
  ASSERT_TRUE(std::ranges::any_of(expected.distance, [](float d) { return d < 0; }));
  for (const FieldMethod method : {FieldMethod::best, FieldMethod::difi})
    expect_equal(compute_field(sites, scene.grid, {.method = method, .sign = SignMethod::winding}), expected,
                 kTolerance * diagonal_of(scene));
}

TEST(FieldAgreement, OfAnyNumberOfThreads) {
  const FieldScene scene = field_scenes()[0];
  const Sites sites(scene.mesh);
  for (const FieldMethodInfo& method : field_methods()) {
    SCOPED_TRACE(method.name);
    const FieldOptions options{.method = method.method, .band = 0.1 * diagonal_of(scene), .sites = true};
    const DistanceField several = compute_field(sites, scene.grid, options);
    const ThreadLimit limit(1);
    const DistanceField one = compute_field(sites, scene.grid, options);
    EXPECT_EQ(std::memcmp(one.distance.data(), several.distance.data(), 4 * one.distance.size()), 0);
    EXPECT_EQ(one.site, several.site);
    EXPECT_EQ(one.report.pairs_culled, several.report.pairs_culled);
    EXPECT_EQ(one.report.evaluations, several.report.evaluations);
  }
}

}  // namespace
}  // namespace sdm::test
