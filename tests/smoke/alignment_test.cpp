// Alignment and the checks of a fit: one small case for each, with a known motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// A block with rings on two sides: no motion and no mirror maps it to itself.
Mesh lopsided() {
  const Mesh body = box({-3, -1.5, -1}, {3, 1.5, 1});
  return joined(joined(body, ring(7, 1.2, {1.5, 0.2, 1.1})), ring(5, 0.5, {-2.5, 1.4, 0.3}));
}

Mesh transformed(Mesh mesh, const Transform& map) {
  transform(mesh, map);
  return mesh;
}

/// The largest distance by which a map moves a vertex.
double motion_of(const Transform& map, const Mesh& mesh) {
  double most = 0;
  for (const Vec3& p : mesh.positions) most = std::max(most, norm(map(p) - p));
  return most;
}

constexpr std::size_t kFewSamples = 515;

TEST(SmokeAlign, FindsTheMotionThatAMeshAndItsPointsWereMovedBy) {
  const Mesh mesh = lopsided();
  const Sites sites(mesh);
  const Transform motion = Transform::translation({0.2, -0.1, 0.15}) * Transform::rotation({3, -4, 5});
  const Mesh o1 = transformed(mesh, motion);
  std::vector<std::uint32_t> groups(mesh.triangles.size(), 0);
  groups.back() = 1;
  const Alignment found = align(o1, sites, {.samples = kFewSamples, .group_of_face = groups});
  EXPECT_TRUE(found.converged);
  EXPECT_LT(motion_of(found.transform * motion, mesh), 1e-6);
  EXPECT_LT(found.after.rms, 1e-6);
  EXPECT_GT(found.before.rms, 0.01);
  ASSERT_EQ(found.groups.size(), 2u);
  EXPECT_GT(found.groups[0].samples, found.groups[1].samples);
  for (const DegreeOfFreedom& freedom : found.freedoms) EXPECT_FALSE(freedom.free);
  EXPECT_THAT(doubts_of(found, {}), ::testing::IsEmpty());

  std::mt19937 random(2);
  const std::vector<Vec3> points = random_surface_points(o1, 701, random);
  const Alignment of_points = align(points, {}, sites, {.samples = kFewSamples});
  EXPECT_LT(motion_of(of_points.transform * motion, mesh), 1e-5);
}

TEST(SmokeAlign, StartsAtPrincipalAxes) {
  const Mesh mesh = lopsided();
  const Transform motion = Transform::translation({30, -10, 15}) * Transform::rotation({120, 50, -70});
  const Mesh o1 = transformed(mesh, motion);
  const Alignment found =
      align(o1, Sites(mesh), {.start = AlignStart::principal_axes, .samples = kFewSamples});
  EXPECT_LT(motion_of(found.transform * motion, mesh), 1e-6);
}

TEST(SmokeAlign, LockedFreedomsStayAndRegionsAlone) {
  const Mesh mesh = lopsided();
  const Sites sites(mesh);
  const Mesh o1 = moved(mesh, {0.1, 0.07, 0.05});
  const std::optional<AlignFreedoms> freedoms = parse_freedoms("xz,ry");
  ASSERT_TRUE(freedoms);
  EXPECT_FALSE(freedoms->all());
  const Alignment found = align(o1, sites, {.samples = kFewSamples, .freedoms = *freedoms});
  EXPECT_NEAR(found.transform.rows[1][3], 0, 1e-9) << "y is locked";
  EXPECT_NEAR(found.transform.rows[0][3], -0.1, 1e-3);
  EXPECT_EQ(std::ranges::count_if(found.freedoms, [](const auto& f) { return f.locked; }), 3);
  EXPECT_FALSE(parse_freedoms("xq"));

  // Only the block counts; the rings of O1 are elsewhere.
  const Mesh body = box({-3, -1.5, -1}, {3, 1.5, 1});
  const Mesh other = joined(moved(body, {0.02, -0.03, 0.04}), ring(12, 1.2, {1.5, 0.2, 1.4}));
  AlignRegion region;
  region.faces.assign(mesh.triangles.size(), 0);
  std::fill_n(region.faces.begin(), 12, 1);
  const Alignment of_region = align(other, sites, {.samples = kFewSamples, .region = region});
  EXPECT_LT(norm(of_region.transform({0, 0, 0}) - Vec3{-0.02, 0.03, -0.04}), 2e-3);
  AlignRegion box;
  box.boxes.push_back({{-3.2, -1.7, -1.2}, {-1, 1, 1.2}});
  EXPECT_FALSE(box.whole());
  EXPECT_LT(norm(align(moved(mesh, {0.01, 0, 0.02}), sites, {.samples = kFewSamples, .region = box})
                     .transform({-3, 0, 0}) -
                 Vec3{-3.01, 0, -0.02}),
            1e-3);
}

TEST(SmokeAlign, ThreeTwoOneIsTheMotionOfSixPoints) {
  const std::vector<Vec3> places{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, -1, 0.5}, {4, -1, 0.5}, {-1, 2, 0.5}};
  const Transform motion = Transform::translation({1, 2, -3}) * Transform::rotation({20, -30, 40});
  std::vector<Vec3> points = places;
  transform(points, motion);
  const Transform found = align_321(points, places);
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_LT(norm(found(points[i]) - places[i]), 1e-12);
}

TEST(SmokeAlign, PartsThatTurnFreelyAreRecognised) {
  const Alignment ball = align(moved(sphere(1), {0.05, 0, 0}), Sites(sphere(2)), {.samples = kFewSamples});
  EXPECT_TRUE(ball.freedoms[5].free);
  EXPECT_THAT(doubts_of(ball, {}), ::testing::Not(::testing::IsEmpty()));
}

/// The part, and points on another one.
struct SmokeFit : ::testing::Test {
  Mesh mesh = lopsided();
  Sites sites{mesh};

  [[nodiscard]] static std::vector<Vec3> points_on(const Mesh& other) {
    std::mt19937 random(4);
    return random_surface_points(other, 701, random);
  }
};
TEST_F(SmokeFit, MirroredPartsAreRecognised) {
  Transform mirror;
  mirror.rows[0][0] = -1;
  const Mesh other = transformed(mesh, mirror);
  const std::optional<MirroredFit> mirrored =
      find_mirrored(other, sites, align(other, sites, {.samples = kFewSamples}));
  ASSERT_TRUE(mirrored);
  EXPECT_LT(mirrored->misfit, 0.25 * mirrored->misfit_as_given);
  const std::vector<Vec3> points = points_on(other);
  EXPECT_TRUE(find_mirrored(points, {}, sites, align(points, {}, sites, {.samples = kFewSamples})));
}

TEST_F(SmokeFit, TheScaleIsFound) {
  const Mesh other = transformed(mesh, Transform::scaling(0.96));
  const std::optional<OtherScale> scale =
      find_scale(other, sites, align(other, sites, {.samples = kFewSamples}));
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->factor, 1 / 0.96, 1e-3);
  const std::vector<Vec3> points = points_on(other);
  const std::optional<OtherScale> of_points =
      find_scale(points, {}, sites, align(points, {}, sites, {.samples = kFewSamples}));
  ASSERT_TRUE(of_points);
  EXPECT_NEAR(of_points->factor, 1 / 0.96, 1e-3);
}

TEST_F(SmokeFit, TheUnitIsFound) {
  const Mesh other = transformed(mesh, Transform::scaling(1 / 25.4));
  const std::vector<Vec3> points = points_on(other);
  EXPECT_EQ(find_other_unit_in_place(other, mesh)->factor, 25.4);
  EXPECT_EQ(find_other_unit_in_place(points, mesh)->factor, 25.4);
  EXPECT_TRUE(sizes_differ(bounds(other), bounds(mesh)));
  const AlignOptions options{.samples = 64, .max_iterations = 20};
  const std::optional<OtherUnit> unit = find_other_unit(other, sites, align(other, sites, options), options);
  ASSERT_TRUE(unit);
  EXPECT_EQ(unit->factor, 25.4);
  const std::optional<OtherUnit> of_points =
      find_other_unit(points, {}, sites, align(points, {}, sites, options), options);
  ASSERT_TRUE(of_points);
  EXPECT_EQ(of_points->factor, 25.4);
}

}  // namespace
}  // namespace sdm::test
