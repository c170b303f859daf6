// Distances to the faces that face the samples.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/map.h>
#include <sdm/summary.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "geometry/vec.h"
#include "map/terrain.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kAccuracy = 1e-6;  // of the engine, relative to the diagonal

/// The distance to a closed triangle, by its plane, sides and corners.
double to_triangle(const Mesh& mesh, std::uint32_t face, const Vec3& q) {
  const Triangle& t = mesh.triangles[face];
  const Vec3 n = normal_of(mesh, face);
  double least = std::numeric_limits<double>::infinity();
  bool over = true;
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = mesh.positions[t[k]], side = mesh.positions[t[(k + 1) % 3]] - a;
    const double along = squared_norm(side) > 0 ? dot(q - a, side) / squared_norm(side) : 0;
    least = std::min(least, norm(q - (a + std::clamp(along, 0.0, 1.0) * side)));
    over = over && dot(cross(n, side), q - a) >= 0;
  }
  return over ? std::min(least, std::abs(dot(n, q - mesh.positions[t[0]]))) : least;
}

/// The least distance to an allowed face; infinite if there is none.
double brute_force(const Mesh& o2, const Vec3& q, const Vec3& normal, double angle) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < o2.triangles.size(); ++f) {
    const Vec3 n = normal_of(o2, f);
    if (n == Vec3{}) continue;
    const double cosine = dot(n, normal);
    if (angle == 90 ? cosine > 0 : cosine >= std::cos(angle * std::numbers::pi / 180) - 1e-12)
      least = std::min(least, to_triangle(o2, f, q));
  }
  return least;
}

void expect_brute_force(const Mesh& o1, const Mesh& o2, double angle) {
  SCOPED_TRACE(angle);
  const Surface surface(o1, {.resolution = 48});
  const DistanceMap map = compute_map(surface, Sites(o2), {.facing = angle});
  Box box = bounds(o1);
  for (const Vec3& p : o2.positions) extend(box, p);
  const double error = 2 * kAccuracy * diagonal(box);
  std::size_t unmatched = 0, wrong = 0;
  for (const std::uint32_t texel : surface.sample_texels()) {
    const Vec3 q = surface.texel_point(texel);
    const double expected = brute_force(o2, q, normal_of(o1, surface.map_faces()[texel]), angle);
    unmatched += std::isinf(expected);
    if (std::isinf(expected))
      wrong += !std::isnan(map.distance[texel]);
    else
      wrong += !(std::abs(std::abs(map.distance[texel]) - expected) <= error);
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(map.without_match, unmatched);
  EXPECT_EQ(map.beyond_max_distance, 0U);
  EXPECT_EQ(map.measured.kind, DistanceKind::facing);
}

TEST(Facing, IsTheClosestAllowedFaceAtEveryTexel) {
  const std::vector<std::pair<Mesh, Mesh>> pairs{{sphere(2), placed(torus(12, 8), "rotate:1:2:3")},
                                                 {torus(12, 8), cube(0.7)},
                                                 {cube(1), sphere(2)},
                                                 {height_field(8), square(1, 0.2)}};
  for (const auto& [o1, o2] : pairs)
    for (const double angle : {15.0, 45.0, 90.0, 120.0, 180.0}) expect_brute_force(o1, o2, angle);
}

TEST(Facing, NeverAllowsFacesWithoutArea) {
  Mesh o2 = square(1, 0);
  // A face without area nearer than the square.
  const auto first = static_cast<std::uint32_t>(o2.positions.size());
  for (const double x : {0.2, 0.4, 0.6}) o2.positions.push_back({x, 0.5, 0.5});
  o2.triangles.push_back({first, first + 1, first + 2});
  const std::vector<Vec3> points{{0.4, 0.5, 0.6}}, normals{{0, 0, 2}};
  const FacingPoints found = closest_facing_points(Sites(o2), points, normals, 90);
  EXPECT_NEAR(found.closest[0].distance, 0.6, 1e-12);
  const std::vector<Vec3> none{{0, 0, 0}};
  EXPECT_EQ(closest_facing_points(Sites(o2), points, none, 90).unmatched[0], 1);
}

TEST(Facing, RefusesWhatItDoesNotHave) {
  const Sites sites(cube());
  const std::vector<Vec3> points{{0, 0, 2}}, normals{{0, 0, 1}};
  EXPECT_NE(error_of([&] { (void)closest_facing_points(sites, points, normals, 0); }), "");
  EXPECT_NE(error_of([&] { (void)closest_facing_points(sites, points, normals, 181); }), "");
  EXPECT_NE(error_of([&] { (void)closest_facing_points(sites, points, {}, 90); }), "");
  EXPECT_NE(error_of([&] { (void)choose_sign(sites, MapOptions{.sign = SignMethod::exact, .facing = 90}); }),
            "");
}

TEST(Facing, CountsWhatIsBeyondTheMaximumApartFromWhatHasNoMatch) {
  const Sites sites(square(1, 0));
  const Surface up(square(1, 0.5), {.resolution = 16}), down(flipped(square(1, 0.5)), {.resolution = 16});
  const DistanceMap far = compute_map(up, sites, {.max_distance = 0.1, .facing = 90}),
                    turned = compute_map(down, sites, {.facing = 90});
  EXPECT_EQ(far.beyond_max_distance, up.sample_texels().size());
  EXPECT_EQ(far.without_match, 0U);
  EXPECT_EQ(turned.without_match, down.sample_texels().size());
  EXPECT_EQ(turned.beyond_max_distance, 0U);
}

/// 10 × 10 × 1 units.
Mesh slab() {
  Mesh mesh = cube(0.5);
  for (Vec3& p : mesh.positions) p = {10 * p[0], 10 * p[1], p[2]};
  return mesh;
}

// The mean normal of a corner is farther than 30° from each of its faces.
TEST(Facing, VerticesAreMeasuredByEachOfTheirFaces) {
  for (const double angle : {1.0, 30.0, 54.0, 90.0})
    for (const float d : distances_at_vertices(slab(), Sites(slab()), {.facing = angle})) EXPECT_EQ(d, 0);
  // Of the distances by the faces, 2 by the upper one and none by the others, the least.
  const Sites lower(square(40, -1.5));
  std::size_t matched = 0;
  for (const float d : distances_at_vertices(slab(), lower, {.facing = 30})) {
    matched += !std::isnan(d);
    if (!std::isnan(d)) {
      EXPECT_NEAR(d, 2, 1e-5);
    }
  }
  EXPECT_EQ(matched, 4U);
}

TEST(Facing, AClosedSurfaceThatIsWoundInwardHasOutwardNormals) {
  Mesh both = slab(), cavity = placed(slab(), "scale:0.5");
  const auto first = static_cast<std::uint32_t>(both.positions.size());
  both.positions.insert(both.positions.end(), cavity.positions.begin(), cavity.positions.end());
  for (const auto& [a, b, c] : cavity.triangles) both.triangles.push_back({first + a, first + c, first + b});
  for (const Mesh& mesh : {slab(), both}) {
    const Mesh inward = flipped(mesh);
    for (const Mesh& o2 : {mesh, inward})
      for (const Mesh& o1 : {mesh, inward}) {
        const Surface surface(o1, {.resolution = 64});
        const Sites sites(o2);
        const DistanceMap map = compute_map(surface, sites, {.facing = 90});
        EXPECT_EQ(map.without_match, 0U);
        for (const std::uint32_t texel : surface.sample_texels()) ASSERT_NEAR(map.distance[texel], 0, 1e-5);
        for (const float d : distances_at_vertices(o1, sites, {.facing = 90})) EXPECT_EQ(d, 0);
      }
  }
}

TEST(Facing, EachGroupStatesWhatItsOwnSamplesLack) {
  const Surface surface(slab(), {.resolution = 64});
  const Sites sites(square(40, -1.5));  // 2 below the upper side; no other side has a match
  const MapOptions options{.max_distance = 1, .facing = 30};
  const DistanceMap map = compute_map(surface, sites, options);
  FaceNames sides{.kind = "group", .names = {"top", "rest"}, .of_face = {}};
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f)
    sides.of_face.push_back(normal_of(surface.mesh(), f)[2] > 0.5 ? 0 : 1);
  const std::vector<GroupTolerance> table{{"top", 0.1}, {"rest", 0.1}};
  const std::vector<float> vertices = distances_at_vertices(surface.mesh(), sites, options);
  const GroupVerdicts verdicts =
      certify_groups(surface, sites, map, vertices, std::span(&sides, 1), table, {.accuracy = 1e-6});
  ASSERT_EQ(verdicts.groups.size(), 2U);
  EXPECT_EQ(verdicts.groups[0].verdict.reason, VerdictReason::beyond_max_distance);
  EXPECT_EQ(verdicts.groups[1].verdict.reason, VerdictReason::without_match);
  const CertifiedVerdict whole =
      certify_tolerance(surface, sites, map, vertices, 0.1, {.error_bound = 0.1, .accuracy = 1e-6});
  EXPECT_EQ(whole.reason, VerdictReason::without_match);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(map.unmatched, 1)), map.without_match);
}

/// A plate over [−5, 25]² from −t to 0.
Mesh plate(double t) {
  Mesh mesh = cube(1);
  for (Vec3& p : mesh.positions) p = {10 + 15 * p[0], 10 + 15 * p[1], t * (p[2] - 1) / 2};
  return mesh;
}

double dent(double x, double y) {
  const double u = std::max(0.0, 1 - ((x - 10) * (x - 10) + (y - 10) * (y - 10)) / 16);
  return -0.79 * u * u;
}

TEST(Facing, FollowsRefits) {
  const Mesh on = sphere(3), other = moved(cube(), {0.3, 0.1, 0});
  const MapOptions options{.facing = 60};
  const auto stretched = [](const Mesh& mesh) {
    Mesh result = mesh;
    for (Vec3& p : result.positions) p = {p[0] + 2 * p[1], 3 * p[1], p[2] - p[0]};
    return result;
  };
  Surface surface(on, {.resolution = 64});
  Sites sites(other);
  static_cast<void>(compute_map(surface, sites, options));
  surface.refit(stretched(on).positions);
  sites.refit(stretched(other).positions);
  const Surface rebuilt(surface.mesh(), {.resolution = 64}, surface.stored_atlas());
  const DistanceMap expected = compute_map(rebuilt, Sites(sites.mesh()), options);
  EXPECT_GT(expected.without_match, 0U);
  const DistanceMap map = compute_map(surface, sites, options);
  EXPECT_EQ(map.without_match, expected.without_match);
  for (const std::uint32_t texel : surface.sample_texels()) {
    if (std::isnan(expected.distance[texel])) continue;
    EXPECT_NEAR(map.distance[texel], expected.distance[texel], 1e-6) << texel;
  }
}

struct Sheets : ::testing::TestWithParam<double> {
  Sites sites{plate(GetParam())};
  Surface surface{terrain(40, dent), {.resolution = 128}};

  [[nodiscard]] Summary judged(const MapOptions& options) const {
    const DistanceMap map = compute_map(surface, sites, options);
    return summarize(
        surface, sites, map, distances_at_vertices(surface.mesh(), sites, options),
        {.accuracy = engine_accuracy(engines().front(), surface.mesh(), sites.mesh()), .tolerance = 0.6});
  }
};

TEST_P(Sheets, ShowADentThatIsDeeperThanTheWall) {
  const MapOptions options{.facing = 90};
  const DistanceMap map = compute_map(surface, sites, options);
  std::size_t wrong_skin = 0;
  for (const std::uint32_t texel : surface.sample_texels()) {
    const double z = surface.texel_point(texel)[2];
    EXPECT_NEAR(map.distance[texel], z, 1e-5);
    wrong_skin += map.vector[texel][2] < -1e-5F;  // the top is above
  }
  EXPECT_EQ(wrong_skin, 0U);
  const Summary summary = judged(options);
  EXPECT_EQ(summary.tolerance->verdict, Verdict::fail);
  EXPECT_NEAR(summary.extremes->min.distance, -0.79, 1e-5);
  EXPECT_FALSE(summary.tolerance->proof);
  EXPECT_FALSE(summary.hausdorff.lower);
  EXPECT_TRUE(std::isinf(summary.evidence.error_bound));
  // Without it, no distance exceeds half of the wall, unless the point is through the other skin: the proof
  // by facing decides. All of an open surface may be within the tolerance of the other skin, and inside out.
  const Summary hidden = judged({});
  EXPECT_EQ(hidden.tolerance->verdict, GetParam() < 0.6 ? Verdict::doubtful : Verdict::fail);
}

TEST_P(Sheets, PassAsAnEstimateWhereItDependsOnSigns) {
  const MapOptions options{.facing = 90};
  const DistanceMap map = compute_map(surface, sites, options);
  const CertifiedVerdict verdict =
      certify_tolerance(surface, sites, map, distances_at_vertices(surface.mesh(), sites, options),
                        Tolerance(-0.8, 0.1), {.error_bound = 0.01, .accuracy = 1e-4});
  EXPECT_EQ(verdict.verdict, Verdict::pass);
  EXPECT_FALSE(verdict.certified);
  EXPECT_TRUE(verdict.proof.value().depends_on_signs);
}

INSTANTIATE_TEST_SUITE_P(Thickness, Sheets, ::testing::Values(0.5, 1.0, 3.0));

}  // namespace
}  // namespace sdm::test
