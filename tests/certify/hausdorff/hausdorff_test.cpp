// The Hausdorff distance: two oracles, known answers, and what users may rely on.
#include <sdm/hausdorff.h>

#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/execution.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "support/error_of.h"
#include "support/hausdorff_oracle.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

HausdorffDistance from(const Mesh& a, const Mesh& b, std::optional<double> precision = {}) {
  return one_sided_hausdorff(a, Sites(b), {.precision = precision});
}

// What holds for every result.
void check(const HausdorffDistance& found, const Mesh& a, const Mesh& b, double precision) {
  const BoundedLength& d = found.distance;
  const double size = scene_diagonal(a, b), rounding = 1e-12 * size;
  EXPECT_LE(d.lower, d.value);
  EXPECT_LE(d.value, d.upper);
  EXPECT_NEAR(d.lower, d.value, rounding);
  EXPECT_LE(d.upper - d.lower, precision + rounding);
  EXPECT_EQ(d.certainty, d.upper - d.lower <= 1e-12 * size ? Certainty::exact : Certainty::bounded);
  ASSERT_TRUE(d.witness);
  const auto& [p, q] = *d.witness;
  EXPECT_NEAR(norm(q - p), d.value, rounding);
  EXPECT_NEAR(oracle::brute_force(b, p), d.value, rounding) << "nothing is closer";
  ASSERT_LT(found.faces[0], a.triangles.size());
  ASSERT_LT(found.faces[1], b.triangles.size());
  const auto off = [](const Mesh& mesh, std::uint32_t face, const Vec3& point) {
    const auto [i, j, k] = mesh.triangles[face];
    return oracle::exact_distance(point, {mesh.positions[i], mesh.positions[j], mesh.positions[k]});
  };
  EXPECT_LE(off(a, found.faces[0], p), rounding);
  EXPECT_LE(off(b, found.faces[1], q), rounding);
}

Mesh grid(int n, unsigned seed, double height = 0, double noise = 0.3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-noise / n, noise / n);
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.positions.push_back({static_cast<double>(x) / n + (x % n != 0 ? offset(random) : 0),
                                static_cast<double>(y) / n + (y % n != 0 ? offset(random) : 0), height});
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (n + 1) + x), c = a + static_cast<std::uint32_t>(n) + 1;
      mesh.triangles.push_back({a, a + 1, c});
      mesh.triangles.push_back({a + 1, c + 1, c});
    }
  return mesh;
}

TEST(Hausdorff, BoundsContainTheTruthOnAnySoup) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    const bool degenerate = seed % 2 == 0;
    const Mesh a = degenerate ? degenerate_soup(12, seed) : soup(12, random),
               b = degenerate ? degenerate_soup(15, seed + 100) : soup(15, random);
    const double size = scene_diagonal(a, b);
    const auto [lower, upper] = oracle::hausdorff_bounds(a, b, 3e-3 * size);
    for (const double precision : {1e-2 * size, 1e-7 * size}) {
      const HausdorffDistance found = from(a, b, precision);
      EXPECT_LE(found.distance.lower, upper) << seed;
      EXPECT_GE(found.distance.upper, lower) << seed;
      check(found, a, b, precision);
    }
  }
}

TEST(Hausdorff, AgreesWithCgal) {
  const std::vector<std::pair<Mesh, Mesh>> pairs{{sphere(2), cube(0.9)},
                                                 {cube(0.9), sphere(2)},
                                                 {torus(12, 8), moved(torus(9, 7), {0.3, 0.1, 0.2})},
                                                 {height_field(8), square(2, 0.2)},
                                                 {load("cow.off", "fit"), load("knot1.off", "fit")}};
  for (const auto& [a, b] : pairs) {
    const double size = scene_diagonal(a, b), error = 1e-3 * size;
    const double expected = oracle::cgal_hausdorff(a, b, error);
    const HausdorffDistance found = from(a, b, 1e-6 * size);
    EXPECT_LE(found.distance.lower, expected + error);
    EXPECT_GE(found.distance.upper, expected - error);
    check(found, a, b, 1e-6 * size);
  }
}

TEST(Hausdorff, NoSampleIsFarther) {
  std::mt19937 random(7);
  const Mesh a = load("cow.off", "fit"), b = load("knot1.off", "fit,translate:0.2:0:0");
  const Sites sites(b);
  const HausdorffDistance found = one_sided_hausdorff(a, sites);
  for (const ClosestPoint& c : closest_points(sites, random_surface_points(a, 20000, random)))
    EXPECT_LE(c.distance, found.distance.upper + 1e-6);
}

TEST(Hausdorff, IsZeroFromASurfaceToItself) {
  for (const Mesh& mesh : {torus(20, 14), fan(30), single_triangle(), load("cow.off")}) {
    const BoundedLength d = from(mesh, mesh).distance;
    EXPECT_EQ(d.lower, 0);
    EXPECT_EQ(d.upper, 0);
    EXPECT_EQ(d.certainty, Certainty::exact);
  }
  const Mesh soup = degenerate_soup(60, 3);
  const double size = scene_diagonal(soup, soup);
  EXPECT_LE(from(soup, soup, 1e-7 * size).distance.upper, 1e-7 * size);
}

// The support of the moved mesh in the direction of the motion is as much larger.
TEST(Hausdorff, IsTheLengthOfATranslation) {
  std::mt19937 random(2);
  const Vec3 by{0.3, -0.2, 0.6};
  for (const Mesh& mesh : {torus(20, 14), sphere(2), cube(), soup(30, random), height_field(9)}) {
    const double size = scene_diagonal(mesh, moved(mesh, by));
    const BoundedLength d = from(moved(mesh, by), mesh, 1e-7 * size).distance;
    EXPECT_LE(d.lower, 0.7 + 1e-14);
    EXPECT_GE(d.upper, 0.7 - 1e-14);
  }
}

TEST(Hausdorff, IsOneSided) {
  const Mesh part = cube(), whole = joined(cube(), moved(sphere(1), {5, 0, 0}));
  EXPECT_EQ(from(part, whole).distance.upper, 0);
  const BoundedLength back = from(whole, part).distance;
  EXPECT_NEAR(back.lower, 5, 1e-12) << "the sphere's farthest vertex, at x = 6, from the face x = 1";
  EXPECT_EQ(back.certainty, Certainty::exact);
}

TEST(Hausdorff, FindsAMaximumInsideAFace) {
  // The origin has three closest points at the distance 1; any other point is closer to one of them.
  Mesh around, triangle;
  for (int i = 0; i < 3; ++i) {
    const double angle = 0.4 + 2 * i * std::numbers::pi / 3, x = std::cos(angle), y = std::sin(angle);
    for (const Vec3& p : {Vec3{x, y, 0}, Vec3{2 * x, 2 * y, 1}, Vec3{2 * x, 2 * y, -1}})
      around.positions.push_back(p);
    const auto first = static_cast<std::uint32_t>(3 * i);
    around.triangles.push_back({first, first + 1, first + 2});
    triangle.positions.push_back({0.5 * std::cos(angle + 0.3), 0.4 * std::sin(angle + 0.3), 0});
  }
  triangle.triangles = {{0, 1, 2}};
  HausdorffDistance found = from(triangle, around, 1e-9);
  check(found, triangle, around, 1e-9);
  EXPECT_NEAR(found.distance.value, 1, 1e-9);
  EXPECT_NEAR(norm((*found.distance.witness)[0]), 0, 1e-8);

  // A triangle that crosses the middle plane of two parallel squares: equally far from both along a line.
  const Mesh sheets = joined(square(4, 0.4), square(4, -0.4));
  const Mesh slanted{.positions = {{-1, -0.5, -0.39}, {1, -0.6, 0.38}, {0.1, 0.9, 0.2}},
                     .triangles = {{0, 1, 2}},
                     .corner_uvs = {}};
  found = from(slanted, sheets, 1e-9);
  check(found, slanted, sheets, 1e-9);
  EXPECT_NEAR(found.distance.value, 0.4, 1e-9);
  EXPECT_NEAR((*found.distance.witness)[0][2], 0, 1e-9);

  // The squares of the sheets cut into other triangles each, with vertices below the line.
  const Mesh finer = joined(grid(7, 1, -0.4), grid(8, 2, 0.4));
  const Mesh between{.positions = {{0.1, 0.2, -0.3}, {0.8, 0.3, 0.3}, {0.4, 0.9, 0.1}},
                     .triangles = {{0, 1, 2}},
                     .corner_uvs = {}};
  EXPECT_NEAR(from(between, finer, 1e-9).distance.upper, 0.4, 1e-9);
}

TEST(Hausdorff, SurfacesMayBeCutIntoOtherTriangles) {
  for (const double height : {0.0, 1e-3, 0.5})
    for (const int n : {1, 9}) {
      const Mesh a = grid(n, 5, height), b = grid(11, 6);
      const HausdorffDistance found = from(a, b, 1e-7);
      check(found, a, b, 1e-7);
      EXPECT_LE(found.distance.lower, height + 1e-14);
      EXPECT_GE(found.distance.upper, height);
    }
}

/// A flat disc of slivers, which all start at one vertex; turned by so many of its steps.
Mesh sliver_disc(std::uint32_t n, std::uint32_t turned) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + turned) / n;
    // In single precision, as of a file.
    mesh.positions.push_back(
        {static_cast<float>(30 * std::cos(angle)), static_cast<float>(30 * std::sin(angle)), 0});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}

// Each sliver lies along many others.
TEST(Hausdorff, LongSliversInAPlaneAreOnePlane) {
  const Mesh a = sliver_disc(128, 0);
  for (const std::uint32_t turned : {32u, 50u}) {
    int steps = 0;
    const HausdorffDistance found =
        one_sided_hausdorff(a, Sites(sliver_disc(128, turned)),
                            {.progress = [&](std::string_view, double) { return ++steps < 500; }});
    EXPECT_LT(found.distance.upper, 1e-4);
  }
}

TEST(Hausdorff, BoundsOfAllPrecisionsOverlap) {
  const Mesh a = load("cow.off", "fit,translate:0.05:0:0"), b = load("knot1.off", "fit");
  const Sites sites(b);
  double lower = 0, upper = std::numeric_limits<double>::infinity();
  for (double precision = 0.1; precision > 1e-11; precision /= 10) {
    const HausdorffDistance found = one_sided_hausdorff(a, sites, {.precision = precision});
    check(found, a, b, precision);
    lower = std::max(lower, found.distance.lower);
    upper = std::min(upper, found.distance.upper);
    EXPECT_LE(lower, upper) << precision;
  }
  EXPECT_LE(upper - lower, 1e-10);
}

TEST(Hausdorff, OfANoisyCopyIsBoundedToAnyPrecision) {
  const Mesh mesh = sphere(4);
  Mesh noisy = mesh;
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 5e-4);
  for (Vec3& p : noisy.positions)
    for (double& x : p) x += noise(random);
  for (const double precision : {1e-3, 1e-5, 1e-7}) {
    const BoundedLength d = from(noisy, mesh, precision).distance;
    EXPECT_LE(d.upper - d.lower, precision);
    EXPECT_GT(d.lower, 5e-4);
    EXPECT_LT(d.lower, 4e-3);
  }
}

TEST(Hausdorff, IsInvariantUnderMotionsAndScales) {
  const Mesh a = load("cow.off", "fit"), b = load("knot1.off", "fit");
  const double expected = from(a, b, 1e-8).distance.lower;
  for (const char* steps : {"rotate:10:20:50", "translate:100:-30:7", "rotate:0:90:0,translate:1e3:0:0"}) {
    const BoundedLength d = from(placed(a, steps), placed(b, steps), 1e-8).distance;
    EXPECT_NEAR(d.lower, expected, 3e-8) << steps;
    EXPECT_LE(d.upper - d.lower, 1e-8);
  }
  for (const double scale : {1e-25, 1e30}) {
    const auto scaled = [&](Mesh mesh) {
      for (Vec3& p : mesh.positions) p = scale * p;
      return mesh;
    };
    const BoundedLength d = from(scaled(a), scaled(b), 1e-8 * scale).distance;
    EXPECT_NEAR(d.lower / scale, expected, 2e-8);
    EXPECT_LE(d.upper - d.lower, 1e-8 * scale);
  }
}

TEST(Hausdorff, MeasuresFromFarAwayAndToDegenerateFaces) {
  const Mesh near = needles(1e-9), far = moved(single_triangle(), {1e9, 0, 0});
  const HausdorffDistance found = from(far, near);
  check(found, far, near, 1e-6 * scene_diagonal(far, near));
  for (unsigned seed : {1u, 2u, 3u}) {
    const Mesh a = needles(1e-7), b = degenerate_soup(40, seed);
    check(from(a, b, 1e-7 * scene_diagonal(a, b)), a, b, 1e-7 * scene_diagonal(a, b));
  }
}

TEST(Hausdorff, IgnoresWhatIsNoPartOfTheSurface) {
  Mesh a = cube();
  a.positions.push_back({50, 0, 0});           // of no face
  a.triangles.push_back({8, 8, 0});            // repeats a corner
  a.triangles.push_back(a.triangles.front());  // repeats a face
  EXPECT_EQ(from(a, cube()).distance.upper, 0);
  Mesh segment = cube();  // a face without area
  segment.positions.push_back({3, 0, 0});
  segment.positions.push_back({2, 0, 0});
  segment.triangles.push_back({8, 9, 9 - 1});
  EXPECT_EQ(from(segment, cube()).distance.upper, 0) << "it repeats a corner";
  segment.triangles.back() = {8, 9, 0};
  EXPECT_NEAR(from(segment, cube()).distance.lower, 2, 1e-12);
  segment.positions[9] = segment.positions[8];
  EXPECT_NEAR(from(segment, cube()).distance.lower, 2, 1e-12) << "two vertices at the same place";
}

TEST(Hausdorff, SymmetricOneIsTheLargerOne) {
  const Sites a(load("cow.off", "fit")), b(load("knot1.off", "fit"));
  const SymmetricHausdorff both = symmetric_hausdorff(a, b, {.precision = 1e-6});
  const SymmetricHausdorff swapped = symmetric_hausdorff(b, a, {.precision = 1e-6});
  for (int i = 0; i < 2; ++i) {
    const Sites &on = i == 0 ? a : b, &to = i == 0 ? b : a;
    const BoundedLength alone = one_sided_hausdorff(on.mesh(), to, {.precision = 1e-6}).distance;
    EXPECT_EQ(both.from[i].distance.lower, alone.lower);
    EXPECT_EQ(both.from[i].distance.upper, alone.upper);
    EXPECT_EQ(swapped.from[1 - i].distance.lower, alone.lower);
  }
  EXPECT_EQ(both.larger.distance.lower, std::max(both.from[0].distance.lower, both.from[1].distance.lower));
  EXPECT_EQ(both.larger.distance.upper, std::max(both.from[0].distance.upper, both.from[1].distance.upper));
  EXPECT_EQ(both.larger.distance.witness, both.from[both.larger_from].distance.witness);
  EXPECT_EQ(both.larger.faces, both.from[both.larger_from].faces);
  EXPECT_NE(both.larger_from, swapped.larger_from);
}

TEST(Hausdorff, DoesNotDependOnTheNumberOfThreads) {
  const Mesh a = load("cow.off", "fit,translate:0.05:0:0"), b = load("knot1.off", "fit");
  const auto result = [&] { return from(a, b, 1e-9); };
  const HausdorffDistance many = result();
  const ThreadLimit alone(1);
  const HausdorffDistance one = result();
  EXPECT_EQ(many.distance.lower, one.distance.lower);
  EXPECT_EQ(many.distance.upper, one.distance.upper);
  EXPECT_EQ(many.distance.witness, one.distance.witness);
  EXPECT_EQ(many.faces, one.faces);
}

TEST(Hausdorff, RejectsWhatItCannotCompute) {
  const Sites sites(cube());
  EXPECT_EQ(error_of([&] { return one_sided_hausdorff(cube(), sites, {.precision = -1}); }),
            "precision is -1: it must be a number greater than 0");
  for (const double bad : {0.0, std::nan("")})
    EXPECT_NE(error_of([&] { return one_sided_hausdorff(cube(), sites, {.precision = bad}); }), "");
  EXPECT_NE(error_of([&] { return one_sided_hausdorff(Mesh(), sites); }), "");
  Mesh broken = cube();
  broken.triangles[0][0] = 99;
  EXPECT_NE(error_of([&] { return one_sided_hausdorff(broken, sites); }), "");
}

TEST(Hausdorff, ReportsProgressAndCanBeCancelled) {
  const Mesh a = grid(9, 5, 0.3), b = grid(11, 6);
  double last = 0;
  const auto watch = [&](std::string_view step, double fraction) {
    EXPECT_TRUE(step == "vertices" || step == "parts") << step;
    EXPECT_TRUE(fraction >= 0 && fraction <= 1);
    last = fraction;
    return true;
  };
  (void)one_sided_hausdorff(a, Sites(b), {.precision = 1e-7, .progress = watch});
  EXPECT_GT(last, 0);
  for (const std::string_view at : {"vertices", "parts"})
    EXPECT_THROW(
        (void)one_sided_hausdorff(
            a, Sites(b),
            {.precision = 1e-7, .progress = [&](std::string_view step, double) { return step != at; }}),
        Cancelled)
        << at;
}

}  // namespace
}  // namespace sdm::test
