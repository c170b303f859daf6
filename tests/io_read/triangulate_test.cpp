#include "io/mesh/polygons/triangulate.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>

namespace sdm {
namespace {

using Polygon = std::vector<Vec3>;

Vec3 twice_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return cross(b - a, c - a);
}

// Triangles tile a simple planar polygon exactly if they all have its orientation, their areas add up to its
// area, and their boundaries cancel except for the sides of the polygon.
void expect_tiling(const Polygon& polygon) {
  io::Triangulator triangulator;
  const auto triangles = triangulator.triangulate(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  Vec3 area{};
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    area += twice_area(polygon[0], polygon[i], polygon[i + 1]);
  const Vec3 normal = normalized(area);
  double sum = 0;
  std::map<std::array<std::uint32_t, 2>, int> sides;
  for (const auto& t : triangles) {
    const double part = dot(normal, twice_area(polygon[t[0]], polygon[t[1]], polygon[t[2]]));
    EXPECT_GE(part, -1e-12 * norm(area));
    sum += part;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  EXPECT_NEAR(sum, norm(area), 1e-12 * norm(area));
  for (std::uint32_t i = 0; i < polygon.size(); ++i) {
    const auto next = static_cast<std::uint32_t>((i + 1) % polygon.size());
    int& side = sides[{std::min(i, next), std::max(i, next)}];
    EXPECT_EQ(side, i < next ? 1 : -1);
    side = 0;
  }
  for (const auto& [side, balance] : sides) EXPECT_EQ(balance, 0);
}

// A polygon about the origin whose radius varies at random, in a tilted plane.
Polygon star(std::mt19937& random, std::size_t n) {
  std::uniform_real_distribution<double> radius(0.1, 1);
  const Vec3 x = normalized({1, 2, 3}), y = normalized(cross(x, {0.3, -1, 2}));
  Polygon polygon;
  for (std::size_t i = 0; i < n; ++i) {
    const double r = radius(random),
                 angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    polygon.push_back(r * std::cos(angle) * x + r * std::sin(angle) * y);
  }
  return polygon;
}

TEST(Triangulate, ConvexQuadsByTheShorterDiagonal) {
  io::Triangulator triangulator;
  const Polygon kite = {{0, 0, 0}, {1, -0.5, 0}, {3, 0, 0}, {1, 0.5, 0}};
  for (int first = 0; first < 4; ++first) {
    Polygon turned;
    for (int k = 0; k < 4; ++k) turned.push_back(kite[(first + k) % 4]);
    for (const auto& t : triangulator.triangulate(turned))  // each has both ends of the short diagonal
      for (const std::size_t end : {std::size_t{1}, std::size_t{3}})
        EXPECT_TRUE(turned[t[0]] == kite[end] || turned[t[1]] == kite[end] || turned[t[2]] == kite[end]);
    expect_tiling(turned);
  }
}

TEST(Triangulate, ConcaveQuadsInEveryPlane) {
  for (int axis = 0; axis < 3; ++axis)
    for (int first = 0; first < 4; ++first)
      for (const double side : {1.0, -1.0}) {
        const double arrow[4][2] = {{0, 0}, {2, -1}, {0.5, 0}, {2, 1}};
        Polygon polygon;
        for (int k = 0; k < 4; ++k) {
          Vec3 p{};
          p[(axis + 1) % 3] = arrow[(first + k) % 4][0];
          p[(axis + 2) % 3] = side * arrow[(first + k) % 4][1];
          polygon.push_back(p);
        }
        expect_tiling(polygon);
      }
}

TEST(Triangulate, KeepsCollinearCornersOnTheBorder) {
  expect_tiling({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
  expect_tiling(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}, {0, 3, 0}, {0, 1, 0}});
}

TEST(Triangulate, RandomStars) {
  std::mt19937 random(7);
  for (std::size_t n = 4; n < 200; ++n) expect_tiling(star(random, n));
}

TEST(Triangulate, Spirals) {
  for (const int n : {8, 20, 60, 150}) {
    Polygon polygon;
    const auto point = [&](int i, double r) {
      const double angle = 0.3 * i;
      return Vec3{(r + angle) * std::cos(angle), (r + angle) * std::sin(angle), 1};
    };
    for (int i = 0; i < n; ++i) polygon.push_back(point(i, 1));
    for (int i = n; i-- > 0;) polygon.push_back(point(i, 3));
    expect_tiling(polygon);
    std::reverse(polygon.begin(), polygon.end());
    expect_tiling(polygon);
  }
}

TEST(Triangulate, CombsAndHolesWithBridges) {
  Polygon comb = {{0, -1, 0}, {20, -1, 0}};
  for (int i = 20; i-- > 0;) comb.push_back({static_cast<double>(i), i % 2 ? 0.0 : 5.0, 0});
  expect_tiling(comb);
  // A square with a square hole: the bridge between them runs there and back.
  expect_tiling({{0, 0, 0},
                 {3, 0, 0},
                 {3, 3, 0},
                 {0, 3, 0},
                 {0, 0, 0},
                 {1, 1, 0},
                 {1, 2, 0},
                 {2, 2, 0},
                 {2, 1, 0},
                 {1, 1, 0}});
}

// Rotates a polygon of the plane z = 0, so that its sides are no longer parallel to the axes.
Polygon rotated(Polygon polygon) {
  for (Vec3& p : polygon) p = {0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1], p[2]};
  return polygon;
}

TEST(Triangulate, PolygonsOfManyCorners) {
  std::mt19937 random(8);
  for (const std::size_t n : {1024, 1025, 1500, 20000}) expect_tiling(star(random, n));
  Polygon circle, comb = {{0, -1, 0}, {5000, -1, 0}}, stairs;
  for (int i = 0; i < 100000; ++i)
    circle.push_back({std::cos(i * 2e-5 * std::numbers::pi), std::sin(i * 2e-5 * std::numbers::pi), 0});
  for (int i = 5000; i-- > 0;) comb.push_back({static_cast<double>(i), i % 2 ? 0.0 : 5000.0, 0});
  for (int i = 0; i < 5000; ++i) {
    stairs.push_back({static_cast<double>(i), static_cast<double>(i), 0});
    stairs.push_back({static_cast<double>(i + 1), static_cast<double>(i), 0});
  }
  stairs.push_back({0, 5000, 0});
  expect_tiling(circle);
  expect_tiling(comb);
  expect_tiling(rotated(comb));
  expect_tiling(stairs);
  expect_tiling(rotated(stairs));
}

// A square with 40 × 40 square holes, each joined to the one before it by a bridge that runs there and back.
TEST(Triangulate, ManyHolesWithBridges) {
  constexpr int kRows = 40;
  Polygon polygon = {{-1, -1, 0}, {kRows, -1, 0}, {kRows, kRows, 0}, {-1, kRows, 0}};
  for (int row = kRows; row-- > 0;) {
    const double y = row;
    polygon.push_back({-1, y, 0});
    Polygon way_back;
    for (int column = 0; column < kRows; ++column) {
      const double x = column;
      polygon.insert(polygon.end(), {{x, y, 0}, {x + 0.25, y + 0.25, 0}, {x + 0.5, y, 0}});
      way_back.insert(way_back.end(), {{x, y, 0}, {x + 0.25, y - 0.25, 0}, {x + 0.5, y, 0}});
    }
    way_back.pop_back();  // the path turns back at the last hole's far corner
    polygon.insert(polygon.end(), way_back.rbegin(), way_back.rend());
    polygon.push_back({-1, y, 0});
  }
  ASSERT_GT(polygon.size(), 8192u);
  expect_tiling(polygon);
  expect_tiling(rotated(polygon));
}

TEST(Triangulate, DegenerateAndSelfIntersectingPolygons) {
  io::Triangulator triangulator;
  EXPECT_EQ(triangulator.triangulate(Polygon(6, Vec3{1, 2, 3})).size(), 4u);
  EXPECT_EQ(triangulator.triangulate(Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
  Polygon pentagram;
  for (int i = 0; i < 5; ++i) pentagram.push_back({std::cos(2.0 * i), std::sin(2.0 * i), 0});
  EXPECT_EQ(triangulator.triangulate(pentagram).size(), 3u);

  std::mt19937 random(9);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  constexpr std::size_t kMany = 10000;
  Polygon tangle, line, three_places, huge;
  for (std::size_t i = 0; i < kMany; ++i) {
    tangle.push_back({coordinate(random), coordinate(random), coordinate(random)});
    line.push_back({coordinate(random), 0, 0});
    three_places.push_back(tangle[i % 3]);
    huge.push_back(1.7e308 * tangle[i]);
  }
  for (const Polygon& polygon :
       {tangle, line, three_places, huge, rotated(line), Polygon(kMany, Vec3{1, 2, 3})})
    EXPECT_EQ(triangulator.triangulate(polygon).size(), kMany - 2);
}

}  // namespace
}  // namespace sdm
