// Parts of the cpu engine that the exactness tests cannot observe.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "closest/finish.h"
#include "closest/point_group.h"
#include "closest/reference/reference_engine.h"
#include "closest/site_lists.h"
#include "geometry/vec.h"
#include "sites/closest_on_face.h"
#include "sites/sites_data.h"
#include "support/map_checks.h"
#include "support/points.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm::closest {
namespace {

double distance(const float (&a)[3], const Vec3& b) {
  return norm(Vec3{a[0], a[1], a[2]} - b);
}

TEST(PointGroup, BallsContainTheirPointsAndChildren) {
  std::mt19937 random(4);
  const auto group = std::make_unique<closest::PointGroup>();
  for (const std::size_t count : {1u, 15u, 16u, 17u, 64u, 65u, 1000u, 4097u, 65536u}) {
    SCOPED_TRACE(count);
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = test::random_point({{-1, -1, -1}, {1, 3, 1}}, random);
    ASSERT_FALSE(group->place(points, {}));
    ASSERT_EQ(group->balls[group->top].size(), 1u);
    for (int level = 0; level <= group->top; ++level) {
      const std::size_t size = closest::PointGroup::points_at(level);
      ASSERT_EQ(group->balls[level].size(), (count + size - 1) / size);
      for (std::size_t i = 0; i < count; ++i) {
        const Ball& ball = group->balls[level][i / size];
        ASSERT_LE(distance(ball.centre, points[i]), 1.00001 * ball.radius + 1e-6);
      }
      for (std::size_t i = 0; level > 0 && i < group->balls[level - 1].size(); ++i) {
        const Ball &inner = group->balls[level - 1][i],
                   &outer = group->balls[level][i / closest::PointGroup::kFan];
        const Vec3 centre{inner.centre[0], inner.centre[1], inner.centre[2]};
        ASSERT_LE(distance(outer.centre, centre) + inner.radius, 1.00001 * outer.radius + 1e-6);
      }
    }
  }
}

// For any winners of the single-precision search, results are local minima, and unsettled queries are
// settled.
TEST(Finish, VerifiesEveryWinner) {
  std::mt19937 random(8);
  const Sites sites(test::soup(40, random));
  std::vector<Vec3> queries(37);
  for (Vec3& q : queries) q = test::random_point({{-1, -1, -1}, {2, 2, 2}}, random);
  constexpr std::size_t kRoom = 48;  // whole packets
  std::vector<ClosestPoint> found(queries.size());
  const auto finish_all = [&](std::uint32_t winner, double limit) {
    const std::vector<std::uint32_t> winners(kRoom, winner);
    finish(internals(sites), {winners.data(), queries.size()}, queries, limit,
           [&](std::size_t first, const sites::ClosestPacket& packet) {
             for (std::size_t i = 0; i < packet.count; ++i)
               found[first + i] = packet.get(i, queries[first + i]);
           });
  };
  const double limit = 0.4;
  finish_all(closest::SiteId::kUnsettled, limit);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint expected = reference::reference_closest(internals(sites), queries[i], limit);
    EXPECT_EQ(found[i].distance, expected.distance);
    EXPECT_EQ(found[i].type, expected.type);
    beyond += expected.type == SiteType::none;
  }
  EXPECT_GT(beyond, 0u);
  EXPECT_LT(beyond, queries.size());

  // Wrong winners: results are points of these sites' faces or of closer neighbours.
  for (const SiteType type : {SiteType::vertex, SiteType::edge, SiteType::face}) {
    finish_all(closest::SiteId::of(type, 7).packed, 1e300);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      ASSERT_NE(found[i].type, SiteType::none);
      EXPECT_NEAR(norm(found[i].point - queries[i]), found[i].distance, 1e-12);
      EXPECT_NEAR(test::distance_to_site(sites, found[i].type, found[i].site, queries[i]), found[i].distance,
                  1e-12);
    }
  }

  finish_all(kNone, 1e300);
  for (const ClosestPoint& c : found) EXPECT_EQ(c.type, SiteType::none);
}

// Soups and grids, flat and rough, whole and small slivers, of any size and place; queries on the mesh, on
// its vertices and lattice points, where regions meet, and away from it.
TEST(Descent, AgreesWithTheReferenceOnRandomScenes) {
  std::size_t within = 0, beyond = 0, wrong = 0;
  const std::vector<test::SimdTarget> targets = test::simd_targets();
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal;
    const auto offset = [&](double size) {
      return size * Vec3{normal(random), normal(random), normal(random)};
    };
    Mesh mesh;
    if (seed % 2 == 0) {
      const std::size_t count = 1 + random() % 300;
      for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 at = offset(1);
        const double size = std::pow(10, -static_cast<double>(random() % 4));
        for (int k = 0; k < 3; ++k) {
          Vec3 p = offset(size);
          if (seed % 3 == 0) p[2] *= 1e-7;
          mesh.positions.push_back(at + p);
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
    } else {
      const auto n = static_cast<std::uint32_t>(2 + random() % 12);
      for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
          mesh.positions.push_back({1.0 * i / n, 1.0 * j / n, seed % 3 == 0 ? 0 : 0.2 * normal(random) / n});
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const std::uint32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
          mesh.triangles.insert(mesh.triangles.end(), {{a, c, random() % 2 ? b : d}, {a, c, d}, {a, d, b}});
        }
    }
    const double scale = std::pow(10, static_cast<double>(random() % 7) - 3);
    const Vec3 place = seed % 5 == 0 ? offset(1000 * scale) : Vec3{};
    for (Vec3& p : mesh.positions) p = scale * p + place;

    const Sites sites(mesh);
    const double extent = diagonal(bounds(mesh)),
                 spread = std::pow(10, static_cast<double>(random() % 4) - 2);
    std::vector<Vec3> queries(400);
    for (Vec3& q : queries) {
      const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
      const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]];
      q = random() % 2 ? a : a + unit(random) * (b - a);
      if (random() % 3 != 0) q += offset(spread * extent);
      if (random() % 5 == 0)
        for (double& x : q) x = std::round(x / (scale / 8)) * (scale / 8);
    }
    const test::UseSimdTarget target(targets[seed % targets.size()]);
    const double limit = seed % 4 == 0 ? 0.1 * extent : std::numeric_limits<double>::infinity();
    auto found = closest_points(sites, queries, {.max_distance = limit});
    if (seed % 3 == 1)  // one at a time
      for (std::size_t i = 0; i < queries.size(); ++i)
        found[i] = closest_points(sites, {&queries[i], 1}, {.max_distance = limit})[0];
    const auto expected = closest_points(sites, queries, {.engine = make_engine("reference")});
    Box scene = bounds(mesh);
    for (const Vec3& q : queries) extend(scene, q);
    const double tolerance = 1e-6 * diagonal(scene);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const bool none = found[i].type == SiteType::none;
      ++(none ? beyond : within);
      wrong += none ? !(expected[i].distance > limit - tolerance)
                    : !(std::abs(found[i].distance - expected[i].distance) <= tolerance);
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(within, 50000u);
  EXPECT_GT(beyond, 1000u);
}

TEST(Reference, IsTheFirstOfAllFacesOneByOne) {
  for (const Mesh& mesh : {test::sphere(3), test::needles(1e-4), test::fan(300)}) {
    const Sites sites(mesh);
    const Box box = bounds(mesh);
    std::mt19937 random(4);
    for (int i = 0; i < 40; ++i) {
      const Vec3 q = test::random_point({2 * box.lower - box.upper, 2 * box.upper - box.lower}, random);
      const auto order = [](const ClosestPoint& c) { return std::tuple(c.distance, c.type, c.site, c.face); };
      ClosestPoint expected;
      for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
        expected =
            std::min(expected, sites::closest_on_face(internals(sites), face, q),
                     [&](const ClosestPoint& a, const ClosestPoint& b) { return order(a) < order(b); });
      for (const double limit : {0.9, 1.0, 1.1}) {
        const ClosestPoint found =
            reference::reference_closest(internals(sites), q, limit * expected.distance);
        if (limit < 1)
          EXPECT_EQ(found.type, SiteType::none);
        else
          EXPECT_EQ(order(found), order(expected));
      }
    }
  }
}

// A packet of points that are far apart has no use for a candidate list: each is searched for by itself.
TEST(Descent, AgreesWithTheReferenceOnScatteredPoints) {
  for (const Mesh& mesh : {test::sphere(5), test::needles(1e-4), test::height_field(60), test::fan(3000)}) {
    const Sites sites(mesh);
    const Box box = bounds(mesh);
    const double tolerance = 1e-6 * diagonal(box);
    for (const test::SimdTarget target : test::simd_targets()) {
      SCOPED_TRACE(test::name(target));
      const test::UseSimdTarget use(target);
      std::mt19937 random(3);
      std::vector<Vec3> queries(60);
      for (Vec3& q : queries)
        q = test::random_point({2 * box.lower - box.upper, 2 * box.upper - box.lower}, random);
      const auto found = closest_points(sites, queries);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const ClosestPoint expected = reference::reference_closest(internals(sites), queries[i],
                                                                   std::numeric_limits<double>::infinity());
        ASSERT_NEAR(found[i].distance, expected.distance, tolerance);
        ASSERT_NEAR(test::distance_to_site(sites, found[i].type, found[i].site, queries[i]),
                    found[i].distance, tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace sdm::closest
