// Signs by the side of an open mesh.
#include <gtest/gtest.h>
#include <sdm/certified_verdict.h>
#include <sdm/map.h>
#include <sdm/vertex_distances.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/vec.h"
#include "map/terrain.h"
#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

double ground(double x, double y) {
  return std::sin(0.5 * x) + 0.5 * std::cos(0.7 * y);
}

TEST(SideOfAnOpenMesh, IsSettlementAndHeaveOfATerrain) {
  const Mesh o2 = terrain(40, ground);
  const Sites sites(o2);
  const Surface moved(terrain(40, [](double x, double y) { return ground(x, y) + 0.3 * std::sin(0.4 * x); }),
                      {.resolution = 128});
  const DistanceMap map = compute_map(moved, sites, {.sign = SignMethod::side});
  EXPECT_EQ(map.sign.method, SignMethod::side);
  const std::vector<std::uint8_t> boundary = boundary_mask(sites, map);
  std::size_t wrong = 0, seen[2] = {0, 0};
  for (const std::uint32_t texel : moved.sample_texels()) {
    const float d = map.distance[texel];
    if (boundary[texel] != 0) {
      wrong += !(d >= 0);
      continue;
    }
    if (std::abs(d) < 1e-4) continue;
    // Above or below the face of the grid that contains (x, y): the height of the mesh, not of the function.
    const Vec3 q = moved.texel_point(texel);
    double height = 0;
    for (std::uint32_t f = 0; f < o2.triangles.size(); ++f) {
      const auto& [a, b, c] = o2.triangles[f];
      const Vec3 p = o2.positions[a], n = normal_of(o2, f);
      const auto side = [&](std::uint32_t from, std::uint32_t to) {
        const Vec3 &u = o2.positions[from], &v = o2.positions[to];
        return (v[0] - u[0]) * (q[1] - u[1]) - (v[1] - u[1]) * (q[0] - u[0]) >= 0;
      };
      if (side(a, b) && side(b, c) && side(c, a))
        height = p[2] - (n[0] * (q[0] - p[0]) + n[1] * (q[1] - p[1])) / n[2];
    }
    wrong += (d < 0) != (q[2] < height);
    ++seen[d < 0];
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(seen[0], 1000U);
  EXPECT_GT(seen[1], 1000U);
}

TEST(SideOfAnOpenMesh, IsExactWhereThereIsAnInside) {
  EXPECT_EQ(choose_sign(Sites(cube()), SignMethod::side).method, SignMethod::exact);
  EXPECT_EQ(choose_sign(Sites(square(1, 0)), SignMethod::side).method, SignMethod::side);
  EXPECT_NE(error_of([] { (void)choose_sign(Sites(band(12, true)), SignMethod::side); }), "");
}

TEST(SideOfAnOpenMesh, IsAnEstimateInVerdicts) {
  const Sites sites(square(1, 0));
  const Surface surface(square(1, 0.05), {.resolution = 32});
  const MapOptions options{.sign = SignMethod::side};
  const auto verdict = [&](const Tolerance& tolerance) {
    return certify_tolerance(surface, sites, compute_map(surface, sites, options),
                             distances_at_vertices(surface.mesh(), sites, options), tolerance,
                             {.error_bound = 0.01, .accuracy = 1e-6});
  };
  EXPECT_EQ(verdict(0.1).verdict, Verdict::pass);
  EXPECT_TRUE(verdict(0.1).certified);
  EXPECT_EQ(verdict({-0.01, 0.1}).verdict, Verdict::not_decided);
  EXPECT_EQ(verdict({-0.01, 0.1}).reason, VerdictReason::estimated_signs);
}

// Samples beside O2 have no sign: their |d| decides only where either sign would.
TEST(SideOfAnOpenMesh, SamplesAtTheBoundaryFailOnlyByBothSigns) {
  const Sites sites(square(1, 0));
  // Behind O2 by 0.05, and up to 0.05 beside it: at most 0.0866 away.
  const Surface surface(square(1.1, -0.05), {.resolution = 32});
  const MapOptions options{.sign = SignMethod::side};
  const DistanceMap map = compute_map(surface, sites, options);
  const std::vector<float> vertices = distances_at_vertices(surface.mesh(), sites, options);
  const auto verdict = [&](const Tolerance& tolerance) {
    return certify_tolerance(surface, sites, map, vertices, tolerance,
                             {.error_bound = 0.05, .accuracy = 1e-6});
  };
  for (const Tolerance& tolerance : {Tolerance(-0.1, 0.01), Tolerance(-0.1, 0)}) {
    EXPECT_EQ(verdict(tolerance).verdict, Verdict::not_decided);
    EXPECT_EQ(verdict(tolerance).reason, VerdictReason::estimated_signs);
    EXPECT_TRUE(verdict(tolerance).within);
    EXPECT_FALSE(verdict(tolerance).certified);
  }
  EXPECT_EQ(verdict({-0.06, 0.01}).verdict, Verdict::fail);  // with either sign
  EXPECT_EQ(verdict({-0.01, 0.1}).verdict, Verdict::fail);   // behind, where there are signs
  const std::vector<std::uint8_t> boundary = boundary_vertices(surface.mesh(), sites);
  EXPECT_EQ(std::ranges::count(boundary, 1), 4);
  EXPECT_EQ(std::ranges::count(boundary_vertices(square(0.5, 1), sites), 1), 0);
}

}  // namespace
}  // namespace sdm::test
