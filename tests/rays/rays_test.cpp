// Rays against meshes: brute force in rational arithmetic, watertightness, and what must not change a result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/barycentric.h"
#include "geometry/line_triangle.h"
#include "geometry/vec.h"
#include "support/engines.h"
#include "support/error_of.h"
#include "support/every_case.h"
#include "support/meshes.h"
#include "support/owned_texels.h"
#include "support/points.h"
#include "support/ray_oracle.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm {
namespace {

Corners corners_of(const Mesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

bool equal(const RayHit& a, const RayHit& b) {
  return a.t == b.t && a.face == b.face && a.barycentric == b.barycentric;
}

/// The faces that Sites does not ignore.
std::vector<std::uint32_t> faces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> faces;
  std::set<Triangle> seen;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle t = mesh.triangles[f];
    std::ranges::sort(t);
    if (t[0] != t[1] && t[1] != t[2] && seen.insert(t).second) faces.push_back(f);
  }
  return faces;
}

/// Brute force over all faces; `near` excludes faces whose bounding sphere the ray's line misses by far.
RayHit brute_force(const Mesh& mesh, std::span<const std::uint32_t> faces, const Ray& ray) {
  RayHit best;
  for (const std::uint32_t f : faces) {
    const Corners c = corners_of(mesh, f);
    double radius = 0, away = norm(c[0] - ray.origin);
    for (const Vec3& p : c) radius = std::max(radius, norm(p - c[0]));
    const Vec3 unit = normalized(ray.direction), to = c[0] - ray.origin;
    if (norm(cross(to, unit)) > 1.001 * radius + 1e-9 * away) continue;
    const auto hit = oracle::ray_in_triangle(ray.origin, ray.direction, c);
    if (!hit || hit->last < ray.t_min || hit->first > ray.t_max) continue;
    const double t = std::max(hit->first, ray.t_min);
    if (t < best.t) {
      best.t = t;
      best.face = f;
    }
  }
  return best;
}

void expect_hits(const Mesh& mesh, const std::vector<Ray>& rays) {
  const Sites sites(mesh);
  const std::vector<std::uint32_t> faces = faces_of(mesh);
  const std::vector<RayHit> hits = first_hits(sites, rays);
  const std::vector<std::uint8_t> any = occluded(sites, rays);
  ASSERT_EQ(hits.size(), rays.size());
  ASSERT_EQ(any.size(), rays.size());
  std::size_t met = 0;
  for (std::size_t i = 0; i < rays.size(); i += test::stride(5)) {
    const Ray& ray = rays[i];
    SCOPED_TRACE(testing::PrintToString(i) + testing::PrintToString(ray.origin) +
                 testing::PrintToString(ray.direction));
    const RayHit expected = brute_force(mesh, faces, ray);
    ASSERT_EQ(hits[i].face == kNone, expected.face == kNone);
    ASSERT_EQ(any[i], expected.face != kNone);
    if (expected.face == kNone) {
      ASSERT_EQ(hits[i].t, kInfinity);
      continue;
    }
    ++met;
    const Corners corners = corners_of(mesh, hits[i].face);
    double size = 0;
    for (const Corners& c : {corners, corners_of(mesh, expected.face)})
      for (const Vec3& p : c) size = std::max(size, norm(p - ray.origin));
    const double tolerance = 2e-11 * size / norm(ray.direction);
    ASSERT_NEAR(hits[i].t, expected.t, tolerance);
    const auto own = oracle::ray_in_triangle(ray.origin, ray.direction, corners);
    ASSERT_TRUE(own) << "the ray does not meet the face";
    ASSERT_GE(hits[i].t, own->first - tolerance);
    ASSERT_LE(hits[i].t, own->last + tolerance);
    const Vec3& w = hits[i].barycentric;
    ASSERT_NEAR(w[0] + w[1] + w[2], 1, 1e-12);
    for (const double weight : w) ASSERT_GE(weight, 0);
    const Vec3 point = w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2];
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(corners[(k + 1) % 3] - corners[k]));
    const bool needle = norm(normal) < 1e-6 * longest * longest;
    const double far = norm(ray.origin) + size + (needle ? 100 * longest : 0);
    ASSERT_LE(norm(point - (ray.origin + hits[i].t * ray.direction)), 1e-9 * far);
  }
  EXPECT_GT(met, 0u);
  EXPECT_LT(met, rays.size());
}

/// Rays of all kinds at a mesh.
std::vector<Ray> make_rays(const Mesh& mesh, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto direction = [&] { return Vec3{u(random), u(random), u(random)}; };
  Box box = bounds(mesh);
  const double size = diagonal(box);
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= 0.2 * size;
    box.upper[k] += 0.2 * size;
  }
  std::uniform_int_distribution<std::size_t> faces(0, mesh.triangles.size() - 1);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const auto& [a, b, c] = mesh.triangles[faces(random)];
    const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    const Vec3 from = test::random_point(box, random);
    const Vec3 edge = p + 0.5 * (1 + u(random)) * (q - p),
               in_plane = u(random) * (q - p) + u(random) * (r - p);
    Vec3 axis{};
    axis[rays.size() % 3] = u(random) > 0 ? 1 : -1;
    const Ray some[] = {{from, direction()},                              // any
                        {from, p - from},                                 // through a vertex
                        {from, edge - from},                              // through an edge, to rounding
                        {p + 2 * in_plane, -in_plane},                    // in a plane, to rounding
                        {p + 3 * (q - p), p - q},                         // along an edge
                        {p, direction()},                                 // from a vertex
                        {from, axis},                                     // with zeros
                        {{p[0], p[1], from[2]}, {0, 0, p[2] - from[2]}},  // exactly through a vertex
                        {from + 1e4 * (from - p), p - from},              // from far away
                        {from, {1e-20 * axis[0], axis[1], 1e-9 * size}},  // nearly with zeros
                        {from, direction(), 0.1 * size, 0.4 * size},      // an interval
                        {from, q - from, 0, 0.999}};                      // that ends just before
    for (const Ray& ray : some)
      if (std::max({std::abs(ray.direction[0]), std::abs(ray.direction[1]), std::abs(ray.direction[2])}) >
          1e-29)
        rays.push_back(ray);
  }
  return rays;
}

class Rays : public testing::TestWithParam<test::SimdTarget> {
  test::UseSimdTarget use_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Targets, Rays, testing::ValuesIn(test::simd_targets()),
                         [](const auto& target) { return test::name(target.param); });

TEST(RaysAlone, AgreeWithRationals) {
  std::mt19937 random(5);
  const Mesh soup = test::soup(150, random);
  expect_hits(soup, make_rays(soup, 600, 1));
  for (const Mesh& mesh :
       {test::sphere(2), test::degenerate_soup(150, 7), test::with_defects(test::sphere(2)), test::cube(),
        test::needles(1e-4), test::height_field(12), test::fan(40)})
    expect_hits(mesh, make_rays(mesh, 300, 2));
}

TEST(RaysAlone, AgreeWithRationalsFarFromTheOrigin) {
  for (const char* steps : {"translate:1e7:-3e7:2e6", "scale:1e-20", "scale:1e15,translate:1e17:0:0"}) {
    SCOPED_TRACE(steps);
    const Mesh mesh = test::placed(test::joined(test::sphere(2), test::degenerate_soup(30, 3)), steps);
    expect_hits(mesh, make_rays(mesh, 300, 3));
  }
}

// Every instruction set returns the same bits as a test of all faces with the exact predicate alone.
TEST_P(Rays, AreThoseOfAllFaces) {
  const Mesh mesh = test::joined(test::sphere(3), test::degenerate_soup(200, 4));
  const Sites sites(mesh);
  const std::vector<std::uint32_t> faces = faces_of(mesh);
  const std::vector<Ray> rays = make_rays(mesh, 6000, 4);
  const std::vector<RayHit> hits = first_hits(sites, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    RayHit best;
    for (const std::uint32_t f : faces)
      if (const auto hit = line_meets_triangle(ray.origin, ray.direction, corners_of(mesh, f));
          hit && hit->last >= ray.t_min && hit->first <= ray.t_max &&
          std::max(hit->first, ray.t_min) < best.t) {
        best.t = std::max(hit->first, ray.t_min);
        best.face = f;
      }
    ASSERT_EQ(hits[i].face, best.face) << i;
    ASSERT_EQ(hits[i].t, best.t) << i;
  }
}

// From inside a closed mesh every ray meets it, also through vertices and edges.
TEST_P(Rays, DoNotPassBetweenFaces) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(0, 1);
  for (const Mesh& mesh : {test::sphere(4), test::moved(test::sphere(3), {1e6, 3, -1e5}), test::cube()}) {
    const Box box = bounds(mesh);
    const Vec3 middle = centre(box);
    const double size = 0.1 * diagonal(box);
    const Box inner{middle - Vec3{size, size, size}, middle + Vec3{size, size, size}};
    std::vector<Ray> rays;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
        const Vec3 from = test::random_point(inner, random);
        for (const Vec3& to : {a, 0.5 * (a + b), a + u(random) * (b - a)}) {
          rays.push_back({from, to - from});
          rays.push_back({middle, to - middle});
        }
      }
    const Sites sites(mesh);
    for (const std::uint8_t met : occluded(sites, rays)) ASSERT_EQ(met, 1);
    for (const RayHit& hit : first_hits(sites, rays)) {
      ASSERT_NE(hit.face, kNone);
      ASSERT_NEAR(hit.t, 1, 1e-8);
    }
  }
}

TEST_P(Rays, AreTheSameAfterARefit) {
  const Mesh first = test::joined(test::sphere(3), test::needles(1e-3));
  Mesh second = first;
  std::mt19937 random(7);
  for (Vec3& p : second.positions)
    p = 3.0 * p + test::random_point({{4.9, -0.1, -0.1}, {5.1, 0.1, 0.1}}, random);
  Sites refitted(first);
  refitted.refit(second.positions);
  const Sites fresh(second);
  const std::vector<Ray> rays = make_rays(second, 5000, 5);
  const std::vector<RayHit> a = first_hits(refitted, rays), b = first_hits(fresh, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(equal(a[i], b[i])) << i;
  EXPECT_EQ(occluded(refitted, rays), occluded(fresh, rays));
}

// A frame in which the extent, and so the scale of the unit frame, changes.
TEST(RaysAlone, OfThinFacesAfterARefit) {
  Mesh mesh = test::sphere(2);
  Sites sites(mesh);
  for (Vec3& p : mesh.positions) p[2] *= 1e-13;  // every face is nearly in one plane
  sites.refit(mesh.positions);
  const std::vector<Ray> rays = make_rays(mesh, 1000, 6);
  const std::vector<RayHit> hits = first_hits(sites, rays), fresh = first_hits(Sites(mesh), rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(equal(hits[i], fresh[i])) << i;
  expect_hits(mesh, std::vector(rays.begin(), rays.begin() + 300));
  for (Vec3& p : mesh.positions) {  // slivers and faces without area
    p[0] = 0;
    p[1] *= 1e-9;
  }
  mesh.positions[0] = {0, 1, 1};
  sites.refit(mesh.positions);
  expect_hits(mesh, make_rays(mesh, 300, 7));
}

TEST_P(Rays, StartWhereTheMapIsFree) {
  for (const char* steps : {"fit,translate:0.9:0:0", "fit,translate:0.3:0.1:0"}) {
    SCOPED_TRACE(steps);
    const Surface surface(test::load("elephant.off", "fit"), {.resolution = 128});
    const Sites sites(test::load("knot1.off", steps));
    for (const std::string& engine : test::engine_names()) {
      const DistanceMap map = compute_map(surface, sites, {.engine = make_engine(engine)});
      const std::vector<double> free = free_distances(surface, sites, map);
      std::vector<Ray> all, late;
      for (const std::uint32_t texel : test::owned_texels(surface)) {
        const Vec3 p = surface.texel_point(texel),
                   v{map.vector[texel][0], map.vector[texel][1], map.vector[texel][2]};
        ASSERT_GE(free[texel], 0);
        ASSERT_LE(free[texel], std::abs(map.distance[texel]));
        ASSERT_GE(free[texel], std::abs(map.distance[texel]) - 1e-5);
        const Vec3 across = normalized(cross(v, {1, 2, 3}));
        for (const Vec3& d : {normalized(v), across, normalized(normalized(v) + 0.5 * across)}) {
          if (d == Vec3{}) continue;
          all.push_back({p, d});
          late.push_back({p, d, free[texel]});
        }
      }
      const std::vector<RayHit> a = first_hits(sites, all), b = first_hits(sites, late);
      for (std::size_t i = 0; i < all.size(); ++i) ASSERT_TRUE(equal(a[i], b[i])) << i;
      EXPECT_EQ(occluded(sites, all), occluded(sites, late));
      // Straight to the closest point.
      std::size_t near = 0;
      for (std::size_t i = 0; i < all.size(); ++i)
        near += a[i].face != kNone && b[i].t < 1.001 * late[i].t_min + 1e-4;
      EXPECT_GT(near, surface.owned_texels() / 2);
    }
  }
}

TEST(RaysAlone, DoNotDependOnThreadsOrOrder) {
  const Mesh mesh = test::sphere(4);
  const Sites sites(mesh);
  const std::vector<Ray> rays = make_rays(mesh, 5000, 8);
  const std::vector<RayHit> all = first_hits(sites, rays);
  const ThreadLimit one(1);
  for (std::size_t i = 0; i < rays.size(); i += 7)
    ASSERT_TRUE(equal(first_hits(sites, std::span(rays).subspan(i, 1))[0], all[i]));
}

TEST(RaysAlone, InIntervals) {
  const Sites sites(test::square(2, 1));
  const Vec3 up{0, 0, 1};
  const auto face = [&](const Ray& ray) { return first_hits(sites, std::vector{ray})[0].face != kNone; };
  EXPECT_TRUE(face({{0.1, 0, 0}, up}));
  EXPECT_FALSE(face({{0.1, 0, 0}, {0, 0, -1}}));
  EXPECT_TRUE(face({{0.1, 0, 0}, up, 1, 1}));
  EXPECT_FALSE(face({{0.1, 0, 0}, up, 1.0000001}));
  EXPECT_FALSE(face({{0.1, 0, 0}, up, 0, 0.9999999}));
  EXPECT_FALSE(face({{0.1, 0, 0}, up, 2, 1})) << "empty";
  EXPECT_FALSE(face({{0.1, 0, 0}, up, kInfinity}));
  EXPECT_TRUE(face({{0.1, 0, 0}, up, 0, 1e300}));
  EXPECT_TRUE(face({{0.1, 0, 1}, up})) << "from the face";
  EXPECT_TRUE(face({{0.1, 0, 1}, up, 0, 0}));
  EXPECT_FALSE(face({{0.1, 0, 1}, up, 1e-9}));
  // In the plane: where it enters, or where it starts.
  const auto t = [&](const Ray& ray) { return first_hits(sites, std::vector{ray})[0].t; };
  EXPECT_EQ(t({{-3, 0.1, 1}, {1, 0, 0}}), 2);
  EXPECT_EQ(t({{0.3, 0.1, 1}, {1, 0, 0}}), 0);
  EXPECT_EQ(t({{-3, 0.1, 1}, {1, 0, 0}, 2.5}), 2.5);
  EXPECT_EQ(t({{-3, 1, 1}, {2, 0, 0}}), 1) << "along the border";
  EXPECT_EQ(t({{-3, 1.0000000001, 1}, {2, 0, 0}}), kInfinity);
  EXPECT_EQ(t({{-3, 0.1, 1}, {1, 0, 0}, 4.5}), kInfinity);
}

// Of the two faces at an edge, and of the six at a vertex, the first.
TEST(RaysAlone, OfFacesAtTheSameDistanceHitTheFirst) {
  const Mesh mesh = test::cube();
  const Sites sites(mesh);
  for (const Vec3& p : mesh.positions) {
    std::uint32_t first = kNone;
    for (std::uint32_t f = 0; f < mesh.triangles.size() && first == kNone; ++f)
      for (const std::uint32_t v : mesh.triangles[f])
        if (mesh.positions[v] == p) first = f;
    EXPECT_EQ(first_hits(sites, std::vector<Ray>{{{}, p}})[0].face, first);
  }
}

// Two corners of a face are so near each other that its area consists of rounding errors.
TEST(RaysAlone, OfANeedleHaveWeightsAtTheirPoint) {
  const Vec3 a{0, 0.1, 0.7}, b{0, 0.9, 0.3}, c{0, std::nextafter(0.9, 1), std::nextafter(0.3, 0)};
  const Mesh mesh{{a, b, c, {0, 0, -1}, {0, 1, -1}, {1, 0, -1}}, {{0, 1, 2}, {3, 4, 5}}, {}};
  const Sites sites(mesh);
  for (const double s : {0.0, 0.1, 0.37, 0.5, 0.93, 1.0}) {
    // In the plane of the face, across it.
    const Vec3 p = a + s * (b - a);
    const std::vector<Ray> rays{{p - Vec3{0, 0.4, 0.7}, {0, 0.4, 0.7}, 0, 2}};
    const RayHit hit = first_hits(sites, rays)[0];
    if (hit.face == kNone) continue;  // beside an end, by rounding
    ASSERT_EQ(hit.face, 0u);
    const Vec3& w = hit.barycentric;
    EXPECT_LE(norm(w[0] * a + w[1] * b + w[2] * c - p), 1e-14) << s;
  }
}

TEST(RaysAlone, Errors) {
  const Sites sites(test::cube());
  const double nan = std::nan("");
  const auto error = [&](const Ray& ray) {
    const std::vector<Ray> rays{{{}, {1, 0, 0}}, ray};
    EXPECT_EQ(test::error_of([&] { return first_hits(sites, rays); }),
              test::error_of([&] { return occluded(sites, rays); }));
    return test::error_of([&] { return first_hits(sites, rays); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(error({{nan, 0, 0}, {1, 0, 0}}), HasSubstr("ray 1 has an origin"));
  EXPECT_THAT(error({{0, 2e37, 0}, {1, 0, 0}}), HasSubstr("ray 1 has an origin"));
  EXPECT_THAT(error({{}, {1, nan, 0}}), HasSubstr("direction"));
  EXPECT_THAT(error({{}, {0, 0, 0}}), HasSubstr("direction"));
  EXPECT_THAT(error({{}, {1e-31, 0, 0}}), HasSubstr("direction"));
  EXPECT_THAT(error({{}, {kInfinity, 0, 0}}), HasSubstr("direction"));
  EXPECT_THAT(error({{}, {1, 0, 0}, -1}), HasSubstr("t_min"));
  EXPECT_THAT(error({{}, {1, 0, 0}, nan}), HasSubstr("t_min"));
  EXPECT_THAT(error({{}, {1, 0, 0}, 0, nan}), HasSubstr("t_max"));
  EXPECT_EQ(error({{1e37, 0, 0}, {-1e37, 1e-300, 0}}), "");
  EXPECT_EQ(error({{1e37, 0, 0}, {-1e-30, 0, 0}}), "");
  EXPECT_TRUE(first_hits(sites, {}).empty());
  EXPECT_TRUE(occluded(sites, {}).empty());
  const std::vector<Ray> rays(10, Ray{{}, {1, 0, 0}});
  EXPECT_THROW((void)first_hits(sites, rays, {.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

}  // namespace
}  // namespace sdm
