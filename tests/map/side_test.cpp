// Signs by the side of an open mesh.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/map.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

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

/// A square sheet of 2 · count² faces with heights by a function, facing up.
template <class Height>
Mesh sheet(double half, int count, const Height& height) {
  Mesh mesh;
  const auto at = [&](int i) { return half * (2.0 * i / count - 1); };
  for (int j = 0; j <= count; ++j)
    for (int i = 0; i <= count; ++i) mesh.positions.push_back({at(i), at(j), height(at(i), at(j))});
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(j * (count + 1) + i); };
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

double flat(double, double) {
  return 0;
}
double dent(double x, double y) {
  return std::max(std::abs(x), std::abs(y)) <= 2 ? -0.05 : 0;
}

ToleranceProof prove_by_side(const Mesh& mesh, const Mesh& o2, const Tolerance& tolerance) {
  return prove_tolerance(mesh, Sites(o2), tolerance, {.sign = SignMethod::side});
}

// A dent behind a plane: most of the surface is on the plane, where no sign is certain, and within the limits
// with either one.
TEST(SideOfAnOpenMesh, PointsWithinTheLimitsByEitherSignAreInside) {
  const Mesh dented = sheet(4, 8, dent);
  for (const Mesh& plane : {sheet(5, 1, flat), sheet(5, 20, flat)})
    for (const Tolerance& tolerance : {Tolerance(-0.1, 0.02), Tolerance(-0.1, 0)})
      EXPECT_EQ(prove_by_side(dented, plane, tolerance).proof, Proof::holds);
  const Mesh plane = sheet(5, 1, flat);
  EXPECT_EQ(prove_by_side(sheet(4, 4, [](double, double) { return -0.05; }), plane, {-0.1, -0.01}).proof,
            Proof::holds);
  EXPECT_EQ(prove_by_side(dented, plane, {-0.04, 0.02}).proof, Proof::fails) << "with either sign";
  // On the side that the limits do not allow; and beside the plane, at its boundary.
  EXPECT_TRUE(prove_by_side(dented, plane, {-0.02, 0.1}).depends_on_signs);
  EXPECT_TRUE(prove_by_side(sheet(5.05, 8, flat), plane, {-0.1, 0.02}).depends_on_signs);
  EXPECT_EQ(prove_by_side(sheet(5.01, 8, flat), plane, {-0.1, 0.02}).proof, Proof::holds);
  // The verdict of a map, which had no proof where samples have only one sign within the limits.
  const Sites sites(plane);
  const Surface surface(dented, {.resolution = 64});
  const MapOptions options{.sign = SignMethod::side};
  const CertifiedVerdict verdict = certify_tolerance(surface, sites, compute_map(surface, sites, options),
                                                     distances_at_vertices(surface.mesh(), sites, options),
                                                     {-0.1, 0.02}, {.error_bound = 0.2, .accuracy = 1e-6});
  EXPECT_EQ(verdict.verdict, Verdict::pass);
  EXPECT_TRUE(verdict.certified);
}

// Of a sharp ridge each face is behind the plane of the other one; of two sheets the nearer one changes.
TEST(SideOfAnOpenMesh, SidesOfRidgesAndStacksAreProvenWhereTheyAreOne) {
  const auto roof = [](double x, double) { return -3 * std::abs(x); };
  for (const double offset : {0.09, -0.09}) {  // at most 0.09 away, and at least 0.028
    const Mesh moved_roof = sheet(4, 20, [&](double x, double y) { return roof(x, y) + offset; });
    const Tolerance allows = offset > 0 ? Tolerance(-0.02, 0.1) : Tolerance(-0.1, 0.02);
    EXPECT_EQ(prove_by_side(moved_roof, sheet(5, 20, roof), allows).proof, Proof::holds);
    EXPECT_TRUE(
        prove_by_side(moved_roof, sheet(5, 20, roof), {-allows.upper, -allows.lower}).depends_on_signs);
  }
  Mesh lid = sheet(5, 1, [](double, double) { return 0.2; });
  const Mesh between = sheet(4, 8, [](double x, double) { return 0.1 + 0.02 * x; });
  EXPECT_TRUE(prove_by_side(between, joined(sheet(5, 1, flat), lid), {-0.01, 0.2}).depends_on_signs);
  for (Triangle& t : lid.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(prove_by_side(between, joined(sheet(5, 1, flat), lid), {-0.01, 0.2}).proof, Proof::holds);
}

// What is proven holds at samples.
TEST(SideOfAnOpenMesh, ProofsHoldAtSamples) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0, 1);
  std::size_t proven = 0;
  for (int run = 0; run < 60; ++run) {
    const double rough = any(random), shift = 0.1 * any(random) - 0.05, noise = 0.04 * any(random);
    const Mesh o2 =
        sheet(5, 12, [&](double x, double) { return std::sin(3 * x) * rough + 0.3 * any(random); });
    const Sites sites(o2);
    Mesh mesh = o2;  // without its rim, moved
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
      return std::ranges::any_of(t, [&](std::uint32_t v) {
        return std::max(std::abs(o2.positions[v][0]), std::abs(o2.positions[v][1])) > 4.9;
      });
    });
    for (Vec3& p : mesh.positions) p[2] += shift + noise * (any(random) - 0.5);
    const Tolerance tolerance(-0.1 - 0.4 * any(random), 0.1 * any(random));
    const ToleranceProof proof = prove_tolerance(mesh, sites, tolerance, {.sign = SignMethod::side});
    if (proof.proof != Proof::holds) continue;
    ++proven;
    std::vector<Vec3> points;
    for (const Triangle& t : mesh.triangles)
      for (int i = 0; i < 20; ++i) {
        const double s = any(random), r = any(random) * (1 - s);
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
        points.push_back(a + s * (b - a) + r * (c - a));
      }
    const std::vector<ClosestPoint> closest = closest_points(sites, points);
    const std::vector<std::uint8_t> behind = inside_flags(sites, points, closest, SignMethod::side);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = behind[i] != 0 ? -closest[i].distance : closest[i].distance;
      EXPECT_TRUE(d >= tolerance.lower - 1e-9 && d <= tolerance.upper + 1e-9) << run << ": " << d;
    }
  }
  EXPECT_GT(proven, 10U);
}

}  // namespace
}  // namespace sdm::test
