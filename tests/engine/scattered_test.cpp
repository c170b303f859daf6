// Closest points of scattered points by the cpu engine: equal, bit by bit, to the least distance of all
// faces.
#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <tuple>
#include <vector>

#include "closest/single_point.h"
#include "geometry/spatial_order.h"
#include "sites/closest_on_face.h"
#include "sites/sites_data.h"
#include "support/degenerate.h"
#include "support/points.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm::closest {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

Mesh moved(Mesh mesh, double scale, double offset) {
  for (Vec3& p : mesh.positions) p = scale * p + Vec3{offset, offset, offset};
  return mesh;
}

// Around a mesh, far from it, near it, and on its vertices and edges.
std::vector<Vec3> queries_for(const Mesh& mesh, std::size_t count, std::mt19937& random) {
  const Box box = bounds(mesh);
  const Vec3 centre = 0.5 * (box.lower + box.upper), half = 0.5 * (box.upper - box.lower);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<std::size_t> any(0, mesh.triangles.size() - 1);
  std::vector<Vec3> queries(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](double times) {
      return centre + times * Vec3{half[0] * unit(random), half[1] * unit(random), half[2] * unit(random)};
    };
    const Triangle& t = mesh.triangles[any(random)];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]];
    switch (i % 6) {
      case 0:
        queries[i] = at(1.5);
        break;
      case 1:
        queries[i] = at(12);
        break;
      case 2:
        queries[i] = at(1000);
        break;
      case 3:
        queries[i] = a;
        break;
      case 4:
        queries[i] = 0.5 * (a + b);
        break;
      default:
        queries[i] = a + 1e-3 * (at(1) - centre);
    }
  }
  return queries;
}

ClosestPoint of_all_faces(const sites::SitesData& sites, const Vec3& q) {
  ClosestPoint best;
  for (const std::uint32_t face : sites.tree.items)
    if (const ClosestPoint c = sites::closest_on_face(sites, face, q); c.distance < best.distance) best = c;
  return best;
}

void expect_least(const Sites& sites, std::span<const Vec3> queries) {
  const std::vector<ClosestPoint> found = closest_points(sites, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint expected = of_all_faces(internals(sites), queries[i]);
    ASSERT_EQ(found[i].distance, expected.distance) << i;
    // The same one where it is found alone; the site is one at that distance.
    const ClosestPoint alone = closest_point(internals(sites), queries[i], kAnywhere);
    ASSERT_EQ(alone.distance, expected.distance) << i;
    ASSERT_EQ(found[i].type, alone.type) << i;
    ASSERT_EQ(found[i].site, alone.site) << i;
    ASSERT_EQ(found[i].point, queries[i] + (alone.point - queries[i])) << i;
    ASSERT_EQ(found[i].face, internals(sites).face_of(alone.type, alone.site)) << i;
  }
}

class ScatteredPoints : public testing::TestWithParam<test::SimdTarget> {
  test::UseSimdTarget target_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Targets, ScatteredPoints, testing::ValuesIn(test::simd_targets()),
                         [](const auto& target) { return test::name(target.param); });

TEST_P(ScatteredPoints, LeastDistanceOfAllFaces) {
  std::mt19937 random(1);
  for (const double scale : {1.0, 1e-12, 1e12})
    for (const double offset : {0.0, 1e6}) {
      SCOPED_TRACE(testing::Message() << scale << ' ' << offset);
      const Mesh mesh = moved(test::soup(300, random), scale, scale * offset);
      expect_least(Sites(mesh), queries_for(mesh, 300, random));
    }
}

TEST_P(ScatteredPoints, DegenerateFacesAndCopies) {
  std::mt19937 random(2);
  for (const double scale : {1.0, 1e-9, 1e9}) {
    const Mesh mesh = moved(test::degenerate_soup(200, random), scale, 0);
    expect_least(Sites(mesh), queries_for(mesh, 400, random));
  }
}

TEST_P(ScatteredPoints, ClosedMesh) {
  std::mt19937 random(3);
  const Mesh mesh = test::sphere(3);
  expect_least(Sites(mesh), queries_for(mesh, 500, random));
}

TEST_P(ScatteredPoints, FacesOfVeryDifferentSize) {
  std::mt19937 random(4);
  Mesh mesh = moved(test::soup(100, random), 1e-4, 0);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : {Vec3{-50, -50, -1}, Vec3{50, -50, -1}, Vec3{0, 80, -1}}) mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  expect_least(Sites(mesh), queries_for(mesh, 400, random));
}

TEST_P(ScatteredPoints, MaxDistance) {
  std::mt19937 random(5);
  const Mesh mesh = test::soup(300, random);
  const Sites sites(mesh);
  const std::vector<Vec3> queries = queries_for(mesh, 300, random);
  const double limit = 0.3;
  const std::vector<ClosestPoint> found = closest_points(sites, queries, {.max_distance = limit});
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint expected = of_all_faces(internals(sites), queries[i]);
    if (expected.distance <= limit) {
      ASSERT_EQ(found[i].distance, expected.distance) << i;
    } else {
      ASSERT_EQ(found[i].type, SiteType::none) << i;
      ++beyond;
    }
  }
  EXPECT_GT(beyond, 0u);
  EXPECT_LT(beyond, queries.size());
}

TEST_P(ScatteredPoints, WithinWhatIsEnough) {
  std::mt19937 random(13);
  for (const double scale : {1.0, 1e-12, 1e12}) {
    const Mesh mesh = moved(test::soup(300, random), scale, 0);
    const Sites sites(mesh);
    std::size_t closest = 0, other = 0;
    for (const Vec3& q : queries_for(mesh, 300, random))
      for (const double enough : {0.0, 0.03 * scale, 0.3 * scale}) {
        const double least = of_all_faces(internals(sites), q).distance;
        const ClosestPoint found = close_point(internals(sites), q, kAnywhere, enough);
        if (least > enough) {
          ASSERT_EQ(found.distance, least);
          ++closest;
        } else {
          ASSERT_LE(found.distance, enough);
          ASSERT_GE(found.distance, least);
          ASSERT_EQ(sites::closest_on_face(internals(sites), found.face, q).distance, found.distance);
          other += found.distance > least ? 1 : 0;
        }
      }
    EXPECT_GT(closest, 0U);
    EXPECT_GT(other, 0U);  // the search did end before
  }
}

// Of faces at the same distance, the first one by type, site and face.
ClosestPoint first_of_all_faces(const sites::SitesData& sites, const Vec3& q) {
  const auto order = [](const ClosestPoint& c) { return std::tuple(c.distance, c.type, c.site, c.face); };
  ClosestPoint best;
  for (const std::uint32_t face : sites.tree.items)
    if (const ClosestPoint c = sites::closest_on_face(sites, face, q); order(c) < order(best)) best = c;
  return best;
}

// From 16 sizes on, by distances relative to that of the mesh; from a million on, in double precision.
TEST_P(ScatteredPoints, ManySizesAway) {
  std::mt19937 random(12);
  std::normal_distribution<double> coordinate;
  const Mesh all[] = {test::soup(200, random), test::degenerate_soup(200, random), test::sphere(3),
                      test::cube(), moved(test::soup(200, random), 1e-9, 1e-3)};
  for (const Mesh& mesh : all) {
    const Sites sites(mesh);
    const Box box = bounds(mesh);
    std::vector<Vec3> queries;
    for (const double away : {17.0, 40.0, 1e3, 1e5, 4e5, 1e6, 1e8})
      for (int i = 0; i < 30; ++i) {
        Vec3 direction;
        for (double& x : direction) x = coordinate(random);
        if (i < 6) {  // where faces tie
          direction = {};
          direction[i % 3] = i < 3 ? 1 : -1;
        }
        queries.push_back(0.5 * (box.lower + box.upper) +
                          away * norm(box.upper - box.lower) / norm(direction) * direction);
      }
    expect_least(sites, queries);
    const std::vector<ClosestPoint> in_packets = closest_points(sites, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Vec3& q = queries[i];
      const ClosestPoint found = closest_point(internals(sites), q, kAnywhere),
                         expected = first_of_all_faces(internals(sites), q);
      ASSERT_EQ(in_packets[i].type, expected.type);
      ASSERT_EQ(in_packets[i].site, expected.site);
      ASSERT_EQ(found.type, expected.type);
      ASSERT_EQ(found.site, expected.site);
      ASSERT_EQ(found.face, expected.face);
      ASSERT_EQ(closest_point(internals(sites), q, found.distance).site, found.site);
      ASSERT_EQ(closest_point(internals(sites), q, std::nextafter(found.distance, 0.0)).type, SiteType::none);
    }
  }
}

// Many of them are not searched in groups, though no leaf is near to their packets.
TEST(Scattered, ManyPointsManySizesAway) {
  std::mt19937 random(13);
  const Sites sites(test::sphere(3));
  std::vector<Vec3> queries(10'000);
  for (Vec3& q : queries) q = Vec3{100, 0, 0} + test::random_point({{0, -50, -50}, {50, 50, 50}}, random);
  const std::vector<ClosestPoint> found = closest_points(sites, queries);
  for (std::size_t i = 0; i < queries.size(); i += 49) {
    const ClosestPoint expected = first_of_all_faces(internals(sites), queries[i]);
    ASSERT_EQ(found[i].distance, expected.distance);
    ASSERT_EQ(found[i].site, expected.site);
  }
}

// Packets in which some points are near, others many sizes away, and the farthest too far for single
// precision.
TEST(Scattered, NearAndFarPointsInOnePacket) {
  std::mt19937 random(14);
  const Mesh mesh = test::sphere(3);
  const Sites sites(mesh);
  std::vector<Vec3> queries;
  for (const double away : {1.5, 60.0, 1e7, 100.0, 2.0, 1e4, 300.0})
    for (int i = 0; i < 2; ++i)
      queries.push_back(away * test::random_point({{0.2, 0.2, 0.2}, {1, 1, 1}}, random));
  for (const double within : {kInfinity, 150.0}) {
    const std::vector<ClosestPoint> found = closest_points(sites, queries, {.max_distance = within});
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const ClosestPoint alone = closest_point(internals(sites), queries[i], within);
      ASSERT_EQ(found[i].type, alone.type);
      ASSERT_EQ(found[i].distance, alone.distance);
      ASSERT_EQ(found[i].site, alone.site);
    }
  }
}

TEST(Scattered, SameInAnyOrderNumberAndThreads) {
  std::mt19937 random(6);
  const Mesh mesh = test::sphere(4);
  const Sites sites(mesh);
  std::vector<Vec3> queries = queries_for(mesh, 5000, random);
  const auto with = [&](unsigned threads, std::span<const Vec3> some) {
    const ThreadLimit limit(threads);
    return closest_points(sites, some);
  };
  const std::vector<ClosestPoint> one = with(1, queries), all = with(0, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    ASSERT_EQ(one[i].distance, all[i].distance);
    ASSERT_EQ(one[i].point, all[i].point);
    ASSERT_EQ(one[i].site, all[i].site);
  }
  std::vector<Vec3> reversed(queries.rbegin(), queries.rend());
  const std::vector<ClosestPoint> backwards = with(0, reversed);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    ASSERT_EQ(one[i].distance, backwards[queries.size() - 1 - i].distance);
    ASSERT_EQ(one[i].point, backwards[queries.size() - 1 - i].point);
  }
}

// Many points close together, in order or not, are searched in groups: equal up to rounding.
TEST(Scattered, DensePoints) {
  std::mt19937 random(7);
  const Mesh mesh = test::sphere(2);
  const Sites sites(mesh);
  std::vector<Vec3> queries(20000);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const double angle = 1e-4 * static_cast<double>(i);
    queries[i] = 1.3 * Vec3{std::cos(angle), std::sin(angle), 0.1 * std::cos(3 * angle)};
  }
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::ranges::shuffle(queries, random);
    const std::vector<ClosestPoint> found = closest_points(sites, queries);
    for (std::size_t i = 0; i < queries.size(); i += 7)
      ASSERT_NEAR(found[i].distance, of_all_faces(internals(sites), queries[i]).distance, 1e-7);
  }
}

// Frames of leaves are made when first needed, also by several threads at once, and anew after a refit.
TEST(Scattered, ConcurrentCallsAndRefits) {
  std::mt19937 random(8);
  Mesh mesh = test::sphere(4);
  Sites sites(mesh);
  for (int frame = 0; frame < 3; ++frame) {
    for (Vec3& p : mesh.positions) p = {1.1 * p[0] + 0.3, p[1], 0.9 * p[2]};
    sites.refit(mesh.positions);
    const std::vector<Vec3> queries = queries_for(mesh, 600, random);
    std::vector<std::vector<ClosestPoint>> found(4);
    std::vector<std::thread> threads;
    for (auto& some : found) threads.emplace_back([&] { some = closest_points(sites, queries); });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double expected = of_all_faces(internals(sites), queries[i]).distance;
      for (const auto& some : found) ASSERT_EQ(some[i].distance, expected);
    }
  }
}

TEST(MortonOrder, IsAPermutationOfNeighbours) {
  std::mt19937 random(9);
  for (const std::size_t count : {0u, 1u, 17u, 1000u, 70000u}) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = test::random_point({{0, 0, 0}, {1, 1, 1}}, random);
    if (count > 20) points[5] = {1e30, -1e30, 0};
    const std::vector<std::uint32_t> order = morton_order(points, {{-2, -2, -2}, {2, 2, 2}});
    ASSERT_EQ(order.size(), count);
    std::vector<bool> seen(count);
    double steps = 0, given = 0;
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_FALSE(seen[order[i]]);
      seen[order[i]] = true;
      if (i == 0 || count <= 20 || order[i] == 5 || order[i - 1] == 5) continue;
      steps += norm(points[order[i]] - points[order[i - 1]]);
      if (i != 5 && i != 6) given += norm(points[i] - points[i - 1]);
    }
    if (count >= 1000) {
      EXPECT_LT(4 * steps, given);
    }
  }
}

}  // namespace
}  // namespace sdm::closest
