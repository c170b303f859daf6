// Queries of points, rays and fields: one small case for each, against brute force or a closed form.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "geometry/vec.h"
#include "smoke/small_meshes.h"
#include "support/map_checks.h"
#include "support/oracle.h"
#include "support/ray_oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

std::vector<double> distances_by_brute_force(const Mesh& mesh, const std::vector<Vec3>& points) {
  std::vector<double> distances;
  for (const Vec3& p : points) distances.push_back(oracle::brute_force(mesh, p));
  return distances;
}

// Numbers of points on both sides of blocks of 256, in no order.
TEST(SmokePoints, ClosestPointsAgreeWithBruteForce) {
  const std::shared_ptr<const Engine> reference = make_engine("reference");
  for (const Mesh& mesh : awkward_meshes()) {
    const Sites sites(mesh);
    for (const std::size_t count : {0, 1, 3, 17, 255, 300}) {
      const std::vector<Vec3> points = random_points(around(mesh), count, 3);
      const std::vector<double> expected = distances_by_brute_force(mesh, points);
      const double size = diagonal(around(mesh));
      const std::vector<ClosestPoint> found = closest_points(sites, points);
      expect_closest_points(sites, points, found, expected, 1e-6 * size);
      expect_closest_points(sites, points, closest_points(sites, points, {.engine = reference}), expected,
                            1e-9 * size);
      for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint on = point_on_face(sites, found[i].type, found[i].site, points[i]);
        Vec3 at{};
        for (std::size_t k = 0; k < 3; ++k)
          at += on.barycentric[k] * mesh.positions[mesh.triangles[on.face][k]];
        EXPECT_LT(norm(at - found[i].point), 1e-9 * size);
      }
    }
  }
}

// A tree of several levels and more than one block of points, some of them farther than the limit.
TEST(SmokePoints, ClosestPointsEndAtTheLargestDistance) {
  const Mesh mesh = torus(24, 17);
  const Sites sites(mesh);
  const std::vector<Vec3> points = random_points(around(mesh), 1201, 5);
  const std::vector<ClosestPoint> all = closest_points(sites, points),
                                  near = closest_points(sites, points, {.max_distance = 0.5});
  std::size_t far = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(all[i].distance, norm(all[i].point - points[i]), 1e-12);
    if (std::abs(all[i].distance - 0.5) < 1e-6) continue;
    EXPECT_EQ(near[i].type == SiteType::none, all[i].distance > 0.5);
    if (near[i].type == SiteType::none) {
      ++far;
    } else {
      EXPECT_NEAR(near[i].distance, all[i].distance, 1e-6);
    }
  }
  EXPECT_GT(far, 100u);
  EXPECT_LT(far, 1190u);
  for (std::size_t i = 0; i < points.size(); i += 50)
    EXPECT_NEAR(all[i].distance, oracle::brute_force(mesh, points[i]), 1e-5);
}

// Points in a cube that are nearly all in the same place of the tree, and points that repeat.
TEST(SmokePoints, ClosestPointsOfClustersAndOfRepeatedPoints) {
  const Mesh mesh = mapped_by(sphere(2), [](const Vec3& p) { return Vec3{3 * p[0], p[1], 0.2 * p[2]}; });
  const Sites sites(mesh);
  std::vector<Vec3> points = random_points({{2.9, 0.1, 0}, {2.95, 0.11, 0.01}}, 530, 8);
  points.insert(points.end(), 65, Vec3{0.1, 0.2, 3});
  points.push_back(mesh.positions[5]);
  expect_closest_points(sites, points, closest_points(sites, points), distances_by_brute_force(mesh, points),
                        2e-5);
}

// Far more points than faces, scattered, so that they are sorted in space and searched in groups.
TEST(SmokePoints, ClosestPointsOfManyScatteredPoints) {
  const Mesh mesh = moved(torus(7, 5), {-300, 20, 1000});
  const Sites sites(mesh);
  const std::vector<Vec3> points = random_points(around(mesh), 4099, 21);
  const std::vector<ClosestPoint> found = closest_points(sites, points),
                                  exact = closest_points(sites, points, {.engine = make_engine("reference")});
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(found[i].distance, exact[i].distance, 2e-5);
  for (std::size_t i = 0; i < points.size(); i += 97)
    EXPECT_NEAR(exact[i].distance, oracle::brute_force(mesh, points[i]), 1e-9);
}

TEST(SmokePoints, FacingPointsAgreeWithBruteForce) {
  for (const double angle : {30.0, 90.0, 180.0}) {
    const Mesh mesh = sphere(1);
    const Sites sites(mesh);
    const std::vector<Vec3> points = random_points(around(mesh), 83, 6);
    std::vector<Vec3> normals = random_points({{-1, -1, -1}, {1, 1, 1}}, points.size(), 7);
    normals[40] = {};
    const FacingPoints found = closest_facing_points(sites, points, normals, angle);
    ASSERT_EQ(found.closest.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      Vec3 of_least{};
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const Vec3 n = normalized(cross(q - p, r - p)), m = normalized(normals[i]);
        if (normals[i] == Vec3{} || dot(n, m) <= std::cos(angle * std::acos(-1.0) / 180)) continue;
        const double distance = oracle::distance(points[i], p, q, r);
        if (distance < least) {
          least = distance;
          of_least = n;
        }
      }
      ASSERT_EQ(found.unmatched[i] != 0, std::isinf(least)) << i;
      if (std::isinf(least)) continue;
      EXPECT_NEAR(found.closest[i].distance, least, 1e-5);
      const Vec3 from = points[i] - found.closest[i].point;
      if (found.closest[i].type == SiteType::face) {
        EXPECT_EQ(found.behind[i] != 0, dot(from, of_least) < 0) << i;
      }
    }
    EXPECT_NE(found.unmatched[40], 0);
  }
}

TEST(SmokePoints, PartsOfAMeshMergeToTheClosestPointsOfTheWhole) {
  const Mesh whole = with_defects(torus(5, 4));
  const Sites sites(whole);
  const std::vector<Vec3> points = random_points(around(whole), 301, 12);
  std::vector<ClosestInParts> best(points.size());
  // Repeated faces have to be in one part: the parts are told apart by the sum of the corners.
  for (std::uint32_t remainder = 0; remainder < 3; ++remainder) {
    Mesh part{.positions = whole.positions, .triangles = {}, .corner_uvs = {}};
    std::vector<std::uint32_t> vertices(whole.positions.size()), edges, faces;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) vertices[v] = v;
    for (std::uint32_t f = 0; f < whole.triangles.size(); ++f) {
      const auto& [a, b, c] = whole.triangles[f];
      if ((a + b + c) % 3 == remainder) {
        part.triangles.push_back(whole.triangles[f]);
        faces.push_back(f);
      }
    }
    const Sites own(part);
    for (const auto& edge : own.edges())
      edges.push_back(
          static_cast<std::uint32_t>(std::ranges::lower_bound(sites.edges(), edge) - sites.edges().begin()));
    merge_closest(own, {.vertices = vertices, .edges = edges, .faces = faces}, points, best);
  }
  const std::vector<ClosestPoint> expected =
      closest_points(sites, points, {.engine = make_engine("reference")});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(best[i].distance, expected[i].distance);
    EXPECT_EQ(best[i].site, expected[i].site);
    EXPECT_EQ(best[i].type, expected[i].type);
  }
}

TEST(SmokePoints, InsideOfSolidsIsDecidedAsByWindingNumbers) {
  const Mesh with_cavity =
      joined(sphere(1), flipped(mapped_by(sphere(0), [](const Vec3& p) { return 0.5 * p; })));
  const Mesh crossing = joined(torus(9, 7), moved(sphere(1), {2, 0.1, 0.2}));
  for (const Mesh& mesh : {with_cavity, crossing, cube(), moved(sphere(1), {1e4, 0, -1e4})}) {
    const Sites sites(mesh);
    EXPECT_EQ(choose_sign(sites, SignMethod::automatic).method, SignMethod::exact);
    for (const std::size_t count : {1, 2, 15, 17, 419}) {
      const std::vector<Vec3> points = random_points(around(mesh), count, 17);
      const std::vector<ClosestPoint> closest = closest_points(sites, points);
      for (const SignMethod method : {SignMethod::exact, SignMethod::winding}) {
        const std::vector<std::uint8_t> inside = inside_flags(sites, points, closest, method);
        for (std::size_t i = 0; i < count; ++i)
          EXPECT_EQ(inside[i] != 0, oracle::winding_number(mesh, points[i]) != 0) << i;
      }
    }
  }
}

// The generalised winding number is the sum of all solid angles over 4π.
double generalised_winding_number(const Mesh& mesh, const Vec3& q) {
  double sum = 0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vec3 a = mesh.positions[ia] - q, b = mesh.positions[ib] - q, c = mesh.positions[ic] - q;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::acos(-1.0));
}

TEST(SmokePoints, InsideOfOpenMeshesAndSoupsIsThatOfTheWindingNumber) {
  std::mt19937 random(2);
  const Mesh open = first_faces(sphere(2), 290), apart = taken_apart(sphere(1), 0.01),
             small = soup(150, random), tilted = first_faces(cube(), 10),
             many = taken_apart(torus(24, 15), 0.02);
  for (const Mesh& mesh : {open, apart, small, tilted, many}) {
    const Sites sites(mesh);
    for (const std::size_t count : {1, 7, 17, 333}) {
      const std::vector<Vec3> points = random_points(bounds(mesh), count, 23);
      const std::vector<std::uint8_t> inside =
          inside_flags(sites, points, closest_points(sites, points), SignMethod::winding);
      for (std::size_t i = 0; i < count; ++i) {
        const double number = generalised_winding_number(mesh, points[i]);
        if (std::abs(number - 0.5) > 1e-9) {
          EXPECT_EQ(inside[i] != 0, number > 0.5) << number;
        }
      }
    }
  }
}

TEST(SmokePoints, SidesOfAnOpenMeshAreThoseOfItsNormals) {
  const Mesh mesh = grid_square(2, 0.5, 5);
  const Sites sites(mesh);
  EXPECT_THROW((void)choose_sign(sites, SignMethod::exact), Error);
  EXPECT_EQ(choose_sign(sites, SignMethod::automatic).method, SignMethod::none);
  const std::vector<Vec3> points = random_points({{-0.9, -0.9, 0}, {0.9, 0.9, 1}}, 270, 9);
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  const std::vector<std::uint8_t> below = inside_flags(sites, points, closest, SignMethod::side),
                                  none = inside_flags(sites, points, closest, SignMethod::none);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(below[i] != 0, points[i][2] < 0.5) << i;
    EXPECT_EQ(none[i], 0);
  }
}

TEST(SmokePoints, RaysHitWhatRationalArithmeticFinds) {
  std::vector<Mesh> meshes = awkward_meshes();
  meshes.push_back(first_faces(needles(1e-6), 41));
  meshes.push_back(torus(5, 7));
  for (const Mesh& mesh : meshes) {
    const Sites sites(mesh);
    const double size = scene_diagonal(mesh, mesh);
    for (const std::size_t count : {0, 1, 17}) {
      const std::vector<Vec3> origins = random_points(around(mesh), count, 31),
                              targets = random_points(bounds(mesh), count, 32);
      std::vector<Ray> rays;
      for (std::size_t i = 0; i < count; ++i) {
        // Some pass exactly through a vertex.
        const Vec3 target =
            i % 3 == 0 ? mesh.positions[mesh.triangles[i % mesh.triangles.size()][0]] : targets[i];
        rays.push_back({origins[i], normalized(target - origins[i]), i % 4 == 1 ? 0.3 * size : 0,
                        i % 4 == 2 ? 0.4 * size : std::numeric_limits<double>::infinity()});
      }
      const std::vector<RayHit> hits = first_hits(sites, rays);
      const std::vector<std::uint8_t> meets = occluded(sites, rays);
      ASSERT_EQ(hits.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        double first = std::numeric_limits<double>::infinity();
        bool near_an_end = false;
        for (const Triangle& t : mesh.triangles) {
          if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
          // Faces far from the line need no rational arithmetic.
          const Vec3 &a = mesh.positions[t[0]], to = a - rays[i].origin;
          const double reach = std::max(norm(mesh.positions[t[1]] - a), norm(mesh.positions[t[2]] - a));
          if (norm(cross(to, rays[i].direction)) > 1.01 * reach + 1e-6 * size) continue;
          const auto in =
              oracle::ray_in_triangle(rays[i].origin, rays[i].direction,
                                      {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
          if (!in) continue;
          near_an_end = near_an_end || std::abs(in->first - rays[i].t_min) < 1e-8 * size ||
                        std::abs(in->first - rays[i].t_max) < 1e-8 * size || in->last > in->first;
          if (in->last >= rays[i].t_min && in->first <= rays[i].t_max) first = std::min(first, in->first);
        }
        if (near_an_end) continue;
        ASSERT_EQ(hits[i].face == kNone, std::isinf(first)) << i;
        EXPECT_EQ(meets[i] != 0, hits[i].face != kNone);
        if (std::isfinite(first)) {
          EXPECT_NEAR(hits[i].t, first, 1e-9 * size + 1e-10 * norm(rays[i].origin));
        }
      }
    }
  }
}

// Thousands of rays, from one place and to all sides, as of a picture and of a scanner.
TEST(SmokePoints, BundlesOfRaysMeetASphereWhereItIs) {
  const Mesh mesh = sphere(3);
  const Sites sites(mesh);
  std::vector<Ray> rays;
  for (int i = 0; i < 41; ++i)
    for (int j = 0; j < 43; ++j)
      rays.push_back({{0, 0, 5}, normalized({0.012 * (i - 20.3), 0.012 * (j - 21.1), -1})});
  for (const Vec3& direction : random_points({{-1, -1, -1}, {1, 1, 1}}, 301, 4))
    rays.push_back({{0.1, 0.2, -0.1}, normalized(direction)});
  const std::vector<RayHit> hits = first_hits(sites, rays);
  const std::vector<std::uint8_t> meets = occluded(sites, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double along = -dot(rays[i].origin, rays[i].direction),
                 height = squared_norm(rays[i].origin) - along * along;
    EXPECT_EQ(meets[i] != 0, hits[i].face != kNone);
    if (std::abs(height - 1) < 0.05) continue;  // faces are inside of the sphere
    ASSERT_EQ(hits[i].face == kNone, height > 1) << i;
    if (height > 1) continue;
    const double half = std::sqrt(1 - height),
                 t = squared_norm(rays[i].origin) > 1 ? along - half : along + half;
    EXPECT_NEAR(hits[i].t, t, 0.07);
  }
}

TEST(SmokePoints, AmbientOcclusionBesideAWallIsAHalf) {
  Mesh wall{.positions = {{0.001, -1e4, -1e4}, {0.001, 1e4, -1e4}, {0.001, 1e4, 1e4}, {0.001, -1e4, 1e4}},
            .triangles = {{0, 1, 2}, {0, 2, 3}},
            .corner_uvs = {}};
  const Surface surface(mapped_by(grid_square(1, 0, 3),
                                  [](const Vec3& p) {
                                    return p - Vec3{0.5, 0, 0};
                                  }),
                        {.resolution = 19});
  const Sites sites(wall);
  const DistanceMap map = compute_map(surface, sites);
  const std::vector<double> free = free_distances(surface, sites, map);
  const auto mean = [&](const AmbientOcclusionOptions& options) {
    const std::vector<float> open = ambient_occlusion(surface, sites, map, options);
    double sum = 0;
    for (const std::uint32_t t : surface.sample_texels()) sum += open[t];
    return sum / static_cast<double>(surface.sample_texels().size());
  };
  EXPECT_NEAR(mean({.rays = 17}), 0.5, 0.02);
  EXPECT_NEAR(mean({.rays = 64, .seed = 3}), 0.5, 0.01);
  EXPECT_NEAR(mean({.rays = 5, .max_distance = 1e-4}), 1, 1e-9);
  for (const std::uint32_t t : surface.sample_texels()) {
    EXPECT_LE(free[t], 0.001 - surface.texel_point(t)[0]);
    EXPECT_GT(free[t], -surface.texel_point(t)[0] - 0.1);
  }
}

// By each way of a field: points one by one, and slices around the surface where there is a limit.
TEST(SmokePoints, FieldsAgreeWithBruteForce) {
  for (const Mesh& mesh : {cube(0.7), sphere(1), first_faces(sphere(1), 77), single_triangle()}) {
    const Sites sites(mesh);
    const bool closed = sites.closed();
    const Grid grid = make_grid(around(mesh), {7, 9, 5});
    FieldReport report;
    const DistanceField all = compute_field(sites, grid, {.sites = true}, report),
                        near = compute_field(sites, grid, {.max_distance = 0.3});
    EXPECT_GT(report.field_bytes, 0u);
    EXPECT_EQ(all.sign.method, closed ? SignMethod::exact : SignMethod::none);
    std::vector<Vec3> points;
    for (std::uint32_t k = 0; k < grid.dims[2]; ++k)
      for (std::uint32_t j = 0; j < grid.dims[1]; ++j)
        for (std::uint32_t i = 0; i < grid.dims[0]; ++i) {
          const Vec3 p = grid.point(i, j, k);
          const std::size_t at = grid.index(i, j, k);
          const double distance = oracle::brute_force(mesh, p);
          points.push_back(p);
          EXPECT_NEAR(std::abs(all.distance[at]), distance, all.accuracy);
          if (closed && distance > 1e-5) {
            EXPECT_EQ(all.distance[at] < 0, oracle::winding_number(mesh, p) != 0);
          }
          EXPECT_NEAR(distance_to_site(sites, all.site_type[at], all.site[at], p), distance, all.accuracy);
          if (std::abs(distance - 0.3) < 1e-5) continue;
          EXPECT_EQ(std::isnan(near.distance[at]), distance > 0.3);
          if (distance < 0.3) {
            EXPECT_NEAR(std::abs(near.distance[at]), distance, near.accuracy);
          }
        }
    for (Vec3& p : points) p = p + Vec3{0.03, -0.05, 0.04};  // some are outside of the grid
    for (const DistanceField* field : {&all, &near}) {
      const std::vector<FieldSample> samples = sample_field(*field, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double sign = closed && oracle::winding_number(mesh, points[i]) != 0 ? -1 : 1,
                     distance = sign * oracle::brute_force(mesh, points[i]);
        EXPECT_LE(samples[i].lower, distance + 1e-9);
        EXPECT_GE(samples[i].upper, distance - 1e-9);
        EXPECT_LE(samples[i].magnitude, std::abs(distance) + 1e-9);
        if (!std::isnan(samples[i].value)) {
          EXPECT_NEAR(samples[i].value, distance, interpolation_error(grid) + field->accuracy);
        }
      }
    }
  }
}

TEST(SmokePoints, GridsWithCubicCellsCoverTheirBox) {
  const Box box{{-1, 2, 3}, {0.5, 2.3, 4}};
  const Grid grid = make_grid(box, 0.4);
  EXPECT_EQ(grid.dims, (std::array<std::uint32_t, 3>{5, 2, 4}));
  EXPECT_LE(grid.point(0, 0, 0)[0], -1);
  EXPECT_GE(grid.point(4, 1, 3)[2], 4 - 1e-12);
  EXPECT_NEAR(interpolation_error(grid), 0.2 * std::sqrt(3.0), 1e-12);
}

// A limit on the distance that is far below the size of the grid, signs that are estimates.
TEST(SmokePoints, NarrowBandsOfFieldsHaveTheDistancesOfTheWholeField) {
  std::mt19937 random(3);
  for (const Mesh& mesh : {torus(16, 9), taken_apart(sphere(2), 0.003)}) {
    const Sites sites(mesh);
    const Grid grid = make_grid(bounds(mesh), {33, 31, 19});
    const DistanceField all = compute_field(sites, grid, {.sign = SignMethod::winding}),
                        near = compute_field(sites, grid, {.sign = SignMethod::winding, .max_distance = 0.1});
    std::size_t values = 0, negative = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      negative += all.distance[i] < 0;
      if (std::isnan(near.distance[i])) {
        EXPECT_GT(std::abs(all.distance[i]), 0.1 - 1e-5);
        continue;
      }
      ++values;
      EXPECT_NEAR(near.distance[i], all.distance[i], 2e-5);
    }
    EXPECT_EQ(near.beyond_max_distance, grid.size() - values);
    EXPECT_GT(values, 500u);
    EXPECT_GT(negative, 500u);
  }
}

}  // namespace
}  // namespace sdm::test
