// The wall thickness: what is known of boxes and tubes, brute force, and what is refused.
#include <gtest/gtest.h>
#include <sdm/measure.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "support/error_of.h"
#include "support/shapes.h"
#include "support/thickness.h"

namespace sdm {
namespace {

constexpr std::uint32_t kLevels = 4;  // of a tube, along its axis

// A tube about the z axis, from −length / 2 to length / 2, with annular ends.
Mesh tube(std::uint32_t facets, double inner, double outer, double length) {
  Mesh mesh;
  for (const double radius : {outer, inner})
    for (std::uint32_t level = 0; level <= kLevels; ++level)
      for (std::uint32_t i = 0; i < facets; ++i) {
        const double a = 2 * std::numbers::pi * i / facets;
        mesh.positions.push_back(
            {radius * std::cos(a), radius * std::sin(a), length * (double(level) / kLevels - 0.5)});
      }
  const auto at = [&](int side, std::uint32_t level, std::uint32_t i) {
    return (side * (kLevels + 1) + level) * facets + i % facets;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < facets; ++i) {
    for (std::uint32_t level = 0; level < kLevels; ++level) {
      quad(at(0, level, i), at(0, level, i + 1), at(0, level + 1, i + 1), at(0, level + 1, i));
      quad(at(1, level, i + 1), at(1, level, i), at(1, level + 1, i), at(1, level + 1, i + 1));
    }
    quad(at(0, kLevels, i), at(0, kLevels, i + 1), at(1, kLevels, i + 1), at(1, kLevels, i));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
  }
  return mesh;
}

struct Measured {
  Measured(const Mesh& mesh, std::uint32_t resolution, double angle = 90)
      : surface(mesh, {.resolution = resolution}),
        sites(mesh),
        maps(test::thickness_maps(surface, sites, angle)) {}
  Surface surface;
  Sites sites;
  test::ThicknessMaps maps;
};

// Facets of an outer and an inner polygon are parallel, and cos(π/n) of the difference of the radii apart.
// From beside the inner facet, the ray goes on to the next one, at the height of its slope.
TEST(Thickness, OfTubesIsTheirWallFartherThanOneWallFromARim) {
  for (const std::uint32_t facets : {12u, 48u, 180u, 720u}) {
    const double wall = 0.4, length = 4;
    const Measured tube_map(tube(facets, 1 - wall, 1, length), 256);
    const double half_turn = std::numbers::pi / facets, least = wall * std::cos(half_turn);
    const double most = wall + 2 * std::tan(half_turn) * std::tan(half_turn);
    std::size_t checked = 0;
    for (const std::uint32_t texel : tube_map.surface.sample_texels()) {
      const Vec3 p = tube_map.surface.texel_point(texel);
      if (std::abs(p[2]) > length / 2 - wall) continue;
      ++checked;
      const double ball = tube_map.maps.ball.distance[texel], ray = tube_map.maps.ray.distance[texel];
      ASSERT_GT(ball, least - 1e-6) << facets << " facets at " << p[0] << ' ' << p[1] << ' ' << p[2];
      ASSERT_LT(ball, most + 1e-6) << facets;
      ASSERT_GT(ray, least - 1e-6) << facets;
      ASSERT_LT(ray, most + 1e-6) << facets;
    }
    EXPECT_GT(checked, 5000u) << facets;
  }
}

TEST(Thickness, OfABoxIsItsExtentAtEveryTexel) {
  const Vec3 half{3, 2, 0.25};
  const Measured map(test::box(half), 256);
  for (const std::uint32_t texel : map.surface.sample_texels()) {
    const Vec3 p = map.surface.texel_point(texel);
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(std::abs(p[k]) - half[k]) < std::abs(std::abs(p[axis]) - half[axis])) axis = k;
    ASSERT_NEAR(map.maps.ray.distance[texel], 2 * half[axis], 1e-6);
    ASSERT_NEAR(map.maps.ball.distance[texel], 2 * half[axis], 1e-6);
    ASSERT_NEAR(std::abs(map.maps.ray.vector[texel][axis]), 2 * half[axis], 1e-6);
  }
  EXPECT_EQ(map.maps.ball.beyond_max_distance, 0u);
  for (const ThicknessMethod method : {ThicknessMethod::ball, ThicknessMethod::ray})
    for (const float d :
         distances_at_vertices(map.sites.mesh(), map.sites, ThicknessOptions{.method = method}))
      EXPECT_NEAR(d, 0.5, 1e-6);
}

// --- Brute force -------------------------------------------------------------------------------------------

using Real = long double;
using Point = std::array<Real, 3>;

Point point_of(const Vec3& p) {
  return {p[0], p[1], p[2]};
}
Real product(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// The squared distance of a point from a triangle by its seven features, in long double: independent of the
// closed form under test.
Real squared_distance(const Point& x, const std::array<Point, 3>& t) {
  Real least = std::numeric_limits<Real>::infinity();
  const auto segment = [&](const Point& a, const Point& b) {
    const Point d = minus(b, a), to = minus(x, a);
    const Real s = std::clamp(product(to, d) / product(d, d), Real(0), Real(1));
    const Point away = minus(to, {s * d[0], s * d[1], s * d[2]});
    least = std::min(least, product(away, away));
  };
  for (int k = 0; k < 3; ++k) segment(t[k], t[(k + 1) % 3]);
  const Point u = minus(t[1], t[0]), v = minus(t[2], t[0]), to = minus(x, t[0]);
  const Real uu = product(u, u), uv = product(u, v), vv = product(v, v), determinant = uu * vv - uv * uv;
  const Real a = (vv * product(to, u) - uv * product(to, v)) / determinant;
  const Real b = (uu * product(to, v) - uv * product(to, u)) / determinant;
  if (a >= 0 && b >= 0 && a + b <= 1) {
    const Point away = minus(to, {a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]});
    least = std::min(least, product(away, away));
  }
  return least;
}

// The largest ball about p + r n that has no point of the triangle inside: by bisection, as balls are nested.
Real largest_radius(const Point& p, const Point& n, const std::array<Point, 3>& t, Real most) {
  const auto is_free = [&](Real r) {
    return squared_distance({p[0] + r * n[0], p[1] + r * n[1], p[2] + r * n[2]}, t) >= r * r;
  };
  if (is_free(most)) return most;
  Real lo = 0, hi = most;
  for (int i = 0; i < 80; ++i) (is_free((lo + hi) / 2) ? lo : hi) = (lo + hi) / 2;
  return lo;
}

// The ball and the ray of each texel, over all faces of its solid, which is oriented outwards; the faces from
// `second` on are another solid.
void expect_brute_force(const Mesh& mesh, double angle, std::uint32_t resolution, std::uint32_t second = 0) {
  const Measured map(mesh, resolution, angle);
  const double size = norm(bounds(mesh).upper - bounds(mesh).lower);
  std::vector<Vec3> normals;
  std::vector<std::array<Point, 3>> faces;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &pa = mesh.positions[a], &pb = mesh.positions[b], &pc = mesh.positions[c];
    const Vec3 normal = cross(pb - pa, pc - pa);
    normals.push_back((1 / norm(normal)) * normal);
    faces.push_back({point_of(pa), point_of(pb), point_of(pc)});
  }
  const auto texels = map.surface.sample_texels();
  const std::size_t step = std::max<std::size_t>(1, texels.size() / 400);
  for (std::size_t i = 0; i < texels.size(); i += step) {
    const std::uint32_t face = map.surface.map_faces()[texels[i]];
    const Vec3 at = map.surface.texel_point(texels[i]), n = -1.0 * normals[face];
    const Point p = point_of(at), inward = point_of(n);
    const auto is_own = [&](std::size_t f) { return (f < second) == (face < second); };
    double ray = kInfinity, turn = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const double speed = dot(normals[f], n);
      if (!is_own(f) || !(speed > 1e-12)) continue;
      const double t = dot(mesh.positions[mesh.triangles[f][0]] - at, normals[f]) / speed;
      const Vec3 q = at + t * n;
      if (t >= -1e-12 && t < ray && squared_distance(point_of(q), faces[f]) < 1e-24 * size * size) {
        ray = t;
        turn = speed;
      }
    }
    const double grazing = -std::cos((std::min(angle, 90.0) + 0.1) * std::numbers::pi / 180);
    Real radius = turn > grazing ? ray / 2 : 4 * size;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (is_own(f) && dot(normals[f], n) > -std::cos((angle + 0.1) * std::numbers::pi / 180))
        radius = std::min(radius, largest_radius(p, inward, faces[f], radius));
    ASSERT_NEAR(map.maps.ray.distance[texels[i]], ray, 1e-7 * size);
    ASSERT_NEAR(map.maps.ball.distance[texels[i]], static_cast<double>(2 * radius), 2e-7 * size);
  }
}

// A mesh that is not convex, without symmetries.
Mesh bumpy(int levels, unsigned seed) {
  Mesh mesh = test::sphere(levels);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> stretch(0.6, 1.4);
  for (Vec3& p : mesh.positions) p = stretch(random) * p;
  return mesh;
}

TEST(Thickness, EqualsBruteForce) {
  for (const double angle : {30.0, 90.0, 135.0}) {
    SCOPED_TRACE(angle);
    expect_brute_force(test::tetrahedron(), angle, 64);
    expect_brute_force(bumpy(2, 1), angle, 128);
    expect_brute_force(test::ring(12), angle, 128);
    expect_brute_force(tube(12, 0.5, 1, 2), angle, 128);
  }
}

TEST(Thickness, OfSolidsThroughEachOtherIsTheirOwn) {
  const Mesh first = bumpy(2, 1);
  expect_brute_force(test::joined(first, bumpy(2, 2)), 90, 128,
                     static_cast<std::uint32_t>(first.triangles.size()));
}

TEST(Thickness, MovesWithThePart) {
  const Mesh mesh = bumpy(2, 3);
  const Mesh laid_out = test::with_own_uvs(mesh, 64), moved = test::moved(laid_out, {1e5, -2e5, 3e5});
  const AtlasOptions options{.kind = AtlasKind::uv, .resolution = 64};
  const Surface here(laid_out, options), there(moved, options);
  const test::ThicknessMaps a = test::thickness_maps(here, Sites(laid_out)),
                            b = test::thickness_maps(there, Sites(moved));
  ASSERT_GT(here.sample_texels().size(), 1000u);
  for (const std::uint32_t texel : here.sample_texels())
    ASSERT_NEAR(a.ball.distance[texel], b.ball.distance[texel], 1e-6);
}

// Two cubes that touch, and one with a cavity.
TEST(Thickness, OfSeveralSolidsIsTheirOwnAndEndsAtCavities) {
  const Measured pair(test::joined(test::cube(), test::moved(test::cube(), {0, 0, 2})), 128);
  for (const std::uint32_t texel : pair.surface.sample_texels()) {
    ASSERT_NEAR(pair.maps.ball.distance[texel], 2, 1e-6);
    ASSERT_NEAR(pair.maps.ray.distance[texel], 2, 1e-6);
  }
  const Measured hollow(test::joined(test::cube(), test::cube(0.5)), 128);
  for (const std::uint32_t texel : hollow.surface.sample_texels()) {
    const Vec3 p = hollow.surface.texel_point(texel);
    const auto middle = std::ranges::count_if(p, [](double x) { return std::abs(x) < 0.45; });
    if (middle != 2) continue;
    ASSERT_NEAR(hollow.maps.ray.distance[texel], 0.5, 1e-6);
    ASSERT_NEAR(hollow.maps.ball.distance[texel], 0.5, 1e-6);
  }
}

TEST(Thickness, DoesNotDependOnTheOrientationOfTheFile) {
  const Mesh mesh = bumpy(2, 5);
  const Measured map(mesh, 64), turned(test::flipped(mesh), 64);
  for (const std::uint32_t texel : map.surface.sample_texels()) ASSERT_GT(map.maps.ball.distance[texel], 0);
  EXPECT_NEAR(statistics(map.surface, map.maps.ball).mean, statistics(turned.surface, turned.maps.ball).mean,
              1e-3);
}

TEST(Thickness, RefusesWhatIsNoSolid) {
  const auto error = [](const Mesh& mesh, double angle) {
    return test::error_of([&] { (void)Measured(mesh, 64, angle); });
  };
  EXPECT_NE(error(test::square(1, 0), 90).find("open"), std::string::npos);
  for (const double angle : {0.0, 180.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NE(error(test::cube(), angle).find("angle is "), std::string::npos);
  const Surface surface(test::cube(), {.resolution = 64});
  const Sites sites(test::tetrahedron());
  EXPECT_NE(
      test::error_of([&] { (void)compute_map(surface, sites, ThicknessOptions{}); }).find("different meshes"),
      std::string::npos);
}

TEST(Thickness, JudgesItsTexelsAndCertifiesNoPass) {
  const Measured map(test::box({3, 2, 0.25}), 128);
  const double accuracy = thickness_accuracy(map.surface.mesh());
  const auto judged = [&](const Tolerance& limits) {
    return *summarize_thickness(map.surface, map.maps.ball, {.accuracy = accuracy, .tolerance = limits})
                .tolerance;
  };
  const CertifiedVerdict pass = judged({0.4, 8}), fail = judged({0.6, 8}), close = judged({0.5, 8});
  EXPECT_EQ(pass.verdict, Verdict::pass);
  EXPECT_FALSE(pass.certified);
  EXPECT_EQ(fail.verdict, Verdict::fail);
  EXPECT_TRUE(fail.certified);
  EXPECT_EQ(close.verdict, Verdict::not_decided);
  const std::vector<std::uint32_t> places = thinnest_texels(map.surface, map.maps.ball, 3);
  ASSERT_EQ(places.size(), 3u);
  for (const std::uint32_t texel : places) EXPECT_NEAR(map.maps.ball.distance[texel], 0.5, 1e-6);
}

TEST(EstimateWalls, FindsTheShareOfThinWalls) {
  Mesh plate = test::cube();
  for (Vec3& p : plate.positions) p = {10 * p[0], 10 * p[1], 0.5 * p[2]};  // 20 × 20 × 1
  const std::optional<WallEstimate> walls = estimate_walls(Sites(plate), 1.2);
  ASSERT_TRUE(walls);
  EXPECT_NEAR(walls->thin, 800.0 / 880, 0.01) << "all but the sides";
  EXPECT_NEAR(walls->median, 1, 1e-9);
  const std::optional<WallEstimate> none = estimate_walls(Sites(plate), 0.9);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->thin, 0);
  EXPECT_EQ(none->median, 0);
  EXPECT_EQ(estimate_walls(Sites(test::cube(10)), 1.2)->thin, 0);
  EXPECT_FALSE(estimate_walls(Sites(test::height_field(8)), 1.2)) << "an open mesh has no walls";
}

TEST(Thickness, MapsStateWhatTheyMeasure) {
  const Mesh mesh = test::cube();
  const Surface surface(mesh, {.resolution = 32});
  const test::ThicknessMaps maps = test::thickness_maps(surface, Sites(mesh));
  EXPECT_EQ(maps.ball.measured.kind, DistanceKind::thickness);
  EXPECT_EQ(maps.ray.measured.kind, DistanceKind::thickness);
  EXPECT_NE(maps.ball.measured.text, maps.ray.measured.text);
  EXPECT_STREQ(name_of(maps.ray.measured.kind), "thickness");
}

}  // namespace
}  // namespace sdm
