// Distances along lines: terrain that was moved by a known function, sheets, and what is refused.
#include <gtest/gtest.h>
#include <sdm/measure.h>
#include <sdm/sdm.h>

#include <cmath>
#include <vector>

#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm {
namespace {

double ground(double x, double y) {
  return 0.3 * std::sin(2 * x) * std::cos(3 * y);
}
// Settlement and heave, linear in x and y, so that it is the same between vertices of equal triangles.
double change(double x, double y) {
  return 0.2 * x - 0.1 * y + 0.01;
}

// n² squares over [−1, 1]², seen from above.
template <class Height>
Mesh terrain(int n, const Height& height, double from = -1, double to = 1) {
  Mesh mesh;
  const auto at = [&](int i) { return from + (to - from) * i / n; };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.positions.push_back({at(i), at(j), height(at(i), at(j))});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1, c = a + n + 2, d = a + n + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

TEST(Along, TheVerticalItIsTheChangeOfHeightOfTerrain) {
  const Mesh before = terrain(40, ground);
  const Mesh after = terrain(40, [](double x, double y) { return ground(x, y) + change(x, y); });
  // Whichever way the direction points; surfaces that are oriented differently have no match.
  for (const bool flip_after : {false, true})
    for (const double up : {1.0, -3.0}) {
      const Surface surface(flip_after ? test::flipped(after) : after, {.resolution = 128});
      const DistanceMap map = compute_map(surface, Sites(before), AlongOptions{.direction = Vec3{0, 0, up}});
      EXPECT_EQ(map.measured.kind, DistanceKind::along);
      std::size_t checked = 0;
      for (const std::uint32_t texel : surface.sample_texels()) {
        const Vec3 p = surface.texel_point(texel);
        if (std::max(std::abs(p[0]), std::abs(p[1])) > 1 - 1e-9) continue;
        if (flip_after) {
          ASSERT_TRUE(std::isnan(map.distance[texel]));
          continue;
        }
        ++checked;
        ASSERT_NEAR(map.distance[texel], change(p[0], p[1]), 1e-6);
        ASSERT_NEAR(map.vector[texel][2], -change(p[0], p[1]), 1e-6);
        ASSERT_EQ(map.vector[texel][0], 0);
      }
      EXPECT_EQ(map.without_match == surface.sample_texels().size(), flip_after);
      EXPECT_EQ(checked > 1000, !flip_after);
    }
}

TEST(Along, TexelsBesideO2HaveNoValueAndAreCounted) {
  const Surface surface(terrain(8, [](double, double) { return 0.5; }), {.resolution = 64});
  const Sites half(terrain(
      8, [](double, double) { return 0.0; }, -0.5, 0.5));
  const DistanceMap map = compute_map(surface, half, AlongOptions{.direction = Vec3{0, 0, 1}});
  std::size_t none = 0;
  for (const std::uint32_t texel : surface.sample_texels()) {
    const Vec3 p = surface.texel_point(texel);
    const bool over = std::max(std::abs(p[0]), std::abs(p[1])) < 0.5;
    none += !over;
    ASSERT_EQ(std::isnan(map.distance[texel]), !over);
    ASSERT_EQ(map.site_type[texel], over ? SiteType::face : SiteType::none);
    if (over) {
      ASSERT_EQ(map.distance[texel], 0.5f);
    }
  }
  EXPECT_EQ(map.without_match, none);
  const DistanceMap near =
      compute_map(surface, half, AlongOptions{.direction = Vec3{0, 0, 1}, .max_distance = 0.4});
  EXPECT_EQ(near.without_match, none);
  EXPECT_EQ(near.beyond_max_distance, surface.sample_texels().size() - none);
  const std::vector<float> at =
      distances_at_vertices(surface.mesh(), half, AlongOptions{.direction = Vec3{0, 0, 1}});
  for (std::size_t v = 0; v < at.size(); ++v) {
    const Vec3& p = surface.mesh().positions[v];
    ASSERT_EQ(std::isnan(at[v]), std::max(std::abs(p[0]), std::abs(p[1])) > 0.5);
  }
}

// A sheet 1 thick with a dent of 0.79 in its upper skin, whose lower skin is nearer than the upper one was.
TEST(Along, NormalsADentIsAsDeepAsItIsInAThinSheet) {
  Mesh sheet = test::cube();
  for (Vec3& p : sheet.positions) p = {10 * p[0], 10 * p[1], 0.5 * p[2]};
  const Mesh dent = terrain(8, [](double, double) { return 0.5 - 0.79; });
  const Surface surface(dent, {.resolution = 64});
  const Sites sites(sheet);
  const DistanceMap along = compute_map(surface, sites, AlongOptions{}),
                    closest = compute_map(surface, sites);
  for (const std::uint32_t texel : surface.sample_texels()) {
    ASSERT_NEAR(along.distance[texel], -0.79, 1e-6);
    ASSERT_NEAR(along.vector[texel][2], 0.79, 1e-6);
    ASSERT_NEAR(closest.distance[texel], -0.21, 1e-6);
  }
}

TEST(Along, ASurfaceAgainstItselfIsZeroAndIsJudgedByItsSamples) {
  const Mesh mesh = test::ring(24);
  const Surface surface(mesh, {.resolution = 128});
  const Sites sites(mesh);
  const DistanceMap map = compute_map(surface, sites, AlongOptions{});
  EXPECT_EQ(map.without_match, 0u);
  for (const std::uint32_t texel : surface.sample_texels()) ASSERT_NEAR(map.distance[texel], 0, 1e-9);
  const std::vector<float> vertices = distances_at_vertices(mesh, sites, AlongOptions{});
  const SummaryOptions options{.accuracy = 1e-6, .tolerance = 0.1};
  const Summary summary = summarize(surface, sites, map, vertices, options);
  EXPECT_TRUE(summary.evidence.samples_only);
  EXPECT_EQ(summary.tolerance->verdict, Verdict::pass);
  EXPECT_FALSE(summary.tolerance->certified);
  EXPECT_FALSE(summary.tolerance->proof);
  EXPECT_FALSE(summary.hausdorff.lower);
}

TEST(Along, AClosedSurfaceThatIsWoundInwardHasOutwardNormals) {
  Mesh sheet = test::cube();
  for (Vec3& p : sheet.positions) p = {10 * p[0], 10 * p[1], 0.5 * p[2]};
  for (const Mesh& o1 : {sheet, test::flipped(sheet)})
    for (const Mesh& o2 : {sheet, test::flipped(sheet)}) {
      const Surface surface(o1, {.resolution = 64});
      const Sites sites(o2);
      const DistanceMap map = compute_map(surface, sites, AlongOptions{});
      EXPECT_EQ(map.without_match, 0u);
      for (const std::uint32_t texel : surface.sample_texels()) ASSERT_NEAR(map.distance[texel], 0, 1e-6);
      for (const float d : distances_at_vertices(o1, sites, AlongOptions{})) EXPECT_NEAR(d, 0, 1e-6);
    }
}

TEST(Along, OfPointsItIsThatOfTheVerticesOfOneFace) {
  const Mesh before = terrain(12, ground);
  const Mesh after = terrain(12, [](double x, double y) { return ground(x, y) + change(x, y); });
  const Sites sites(before);
  const Vec3 up{0, 0, 2};
  const std::vector<Vec3> normals(after.positions.size(), up), down(after.positions.size(), -1.0 * up);
  const std::vector<float> expected = distances_at_vertices(after, sites, AlongOptions{.direction = up});
  const FacingPoints facing = closest_points_along(sites, after.positions, normals, {.direction = up}),
                     turned = closest_points_along(sites, after.positions, down, {.direction = up}),
                     any = closest_points_along(sites, after.positions, {}, {.direction = -1.0 * up}),
                     near = closest_points_along(sites, after.positions, {},
                                                 {.direction = up, .max_distance = 0.05});
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double signed_distance = (facing.behind[i] ? -1 : 1) * facing.closest[i].distance;
    ASSERT_EQ(static_cast<float>(signed_distance), expected[i]);
    ASSERT_EQ(facing.closest[i].type, SiteType::face);
    ASSERT_NEAR(norm(facing.closest[i].point - after.positions[i]), facing.closest[i].distance, 1e-12);
    ASSERT_EQ(turned.unmatched[i], 1);
    ASSERT_EQ(any.closest[i].distance, facing.closest[i].distance);
    ASSERT_EQ(any.behind[i], facing.behind[i]);
    ASSERT_EQ(near.closest[i].type == SiteType::none, facing.closest[i].distance > 0.05);
    ASSERT_EQ(near.unmatched[i], 0);
  }
  const FacingPoints along_normals = closest_points_along(sites, after.positions, normals, {});
  EXPECT_EQ(along_normals.closest[0].distance, facing.closest[0].distance);
  EXPECT_NE(test::error_of([&] { (void)closest_points_along(sites, after.positions, {}, {}); }), "");
  EXPECT_NE(
      test::error_of([&] {
        (void)closest_points_along(sites, std::vector<Vec3>{{std::nan(""), 0, 0}}, {}, {.direction = up});
      }),
      "");
}

TEST(Along, VerticesOfASolidAreMeasuredToTheSkinThatFacesTheSameWay) {
  const Mesh o1 = test::cube(), o2 = test::cube(2);  // half sides
  const Sites sites(o2);
  const Vec3 direction{0, 0, 1};
  const std::vector<float> at = distances_at_vertices(o1, sites, AlongOptions{.direction = direction});
  for (std::size_t v = 0; v < at.size(); ++v) ASSERT_EQ(at[v], -1.0f);
  const Mesh raised = test::moved(o1, {0, 0, 0.25});
  const std::vector<float> moved_at =
      distances_at_vertices(raised, sites, AlongOptions{.direction = direction});
  for (std::size_t v = 0; v < at.size(); ++v)
    ASSERT_EQ(moved_at[v], o1.positions[v][2] > 0 ? -0.75f : -1.25f);
}

TEST(Along, SignsAreThoseOfTheSideOfTheFace) {
  const Surface surface(terrain(4, [](double, double) { return 0.5; }), {.resolution = 64});
  const Sites open(terrain(4, [](double, double) { return 0.0; }));
  EXPECT_EQ(compute_map(surface, open, AlongOptions{}).sign.method, SignMethod::side);
  EXPECT_EQ(compute_map(surface, Sites(test::cube()), AlongOptions{}).sign.method, SignMethod::side);
}

TEST(Along, RefusesOptionsOutOfRange) {
  const Surface surface(test::cube(), {.resolution = 64});
  const Sites sites(test::cube());
  for (const Vec3& direction : {Vec3{0, 0, 0}, Vec3{kInfinity, 0, 0}, Vec3{0, std::nan(""), 1}})
    EXPECT_NE(test::error_of([&] {
                (void)compute_map(surface, sites, AlongOptions{.direction = direction});
              }).find("it must be normal or a direction of three numbers, not all 0"),
              std::string::npos);
  EXPECT_NE(test::error_of([&] {
              (void)compute_map(surface, sites, AlongOptions{.max_distance = 0});
            }).find("greater than 0"),
            std::string::npos);
}

}  // namespace
}  // namespace sdm
