#include "atlas/charts/overlap.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sdm::atlas {
namespace {

// The area of the first triangle clipped to the second (Sutherland & Hodgman 1974).
double common_area(const atlas::GridTriangle& a, const atlas::GridTriangle& b) {
  if (orientation(b[0], b[1], b[2]) == 0) return 0;
  std::vector<Vec2> polygon;
  for (const atlas::GridPoint& p : a) polygon.push_back({1.0 * p[0], 1.0 * p[1]});
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    const Vec2 p = {1.0 * b[k][0], 1.0 * b[k][1]}, q = {1.0 * b[(k + 1) % 3][0], 1.0 * b[(k + 1) % 3][1]};
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 &r = polygon[i], &s = polygon[(i + 1) % polygon.size()];
      const double from = cross(q - p, r - p), to = cross(q - p, s - p);
      if (from >= 0) kept.push_back(r);
      if ((from > 0 && to < 0) || (from < 0 && to > 0)) kept.push_back(r + (from / (from - to)) * (s - r));
    }
    polygon = kept;
  }
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return twice / 2;
}

atlas::GridTriangle random_triangle(std::mt19937& random, int lo, int hi) {
  std::uniform_int_distribution<std::int32_t> coordinate(lo, hi);
  atlas::GridTriangle t;
  for (atlas::GridPoint& p : t) p = {coordinate(random), coordinate(random)};
  if (orientation(t[0], t[1], t[2]) < 0) std::swap(t[1], t[2]);
  return t;
}

// On few grid points, so that shared corners, touching edges and zero areas are common.
TEST(Overlap, PairsWithACommonArea) {
  std::mt19937 random(1);
  int overlaps = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::array<atlas::GridTriangle, 2> pair = {random_triangle(random, 0, 7),
                                                     random_triangle(random, 3, 10)};
    const bool expected = common_area(pair[0], pair[1]) > 1e-9;
    ASSERT_EQ(atlas::find_overlap(pair).has_value(), expected) << i;
    overlaps += expected;
  }
  EXPECT_GT(overlaps, 10000);
  EXPECT_LT(overlaps, 90000);
}

TEST(Overlap, IsExactAtTheLimitsOfTheGrid) {
  const atlas::GridPoint o = {0, 0}, x = {atlas::kGridSteps, atlas::kGridSteps - 1},
                         y = {atlas::kGridSteps, atlas::kGridSteps};
  // Two slivers on both sides of the line from o to y, which touch, then overlap by one step.
  const atlas::GridPoint above = {atlas::kGridSteps - 1, atlas::kGridSteps};
  EXPECT_FALSE(atlas::find_overlap(
      std::array<atlas::GridTriangle, 2>{atlas::GridTriangle{o, x, y}, atlas::GridTriangle{o, y, above}}));
  EXPECT_TRUE(atlas::find_overlap(std::array<atlas::GridTriangle, 2>{atlas::GridTriangle{o, x, above},
                                                                     atlas::GridTriangle{o, y, above}}));
}

// A triangulated grid has no overlap, whatever the order; one triangle more has.
TEST(Overlap, IsFoundAmongMany) {
  std::mt19937 random(2);
  std::vector<atlas::GridTriangle> triangles;
  for (std::int32_t y = 0; y < 60; ++y)
    for (std::int32_t x = 0; x < 60; ++x) {
      const atlas::GridPoint a = {1000 * x, 1000 * y}, b = {a[0] + 1000, a[1]},
                             c = {a[0] + 1000, a[1] + 1000}, d = {a[0], a[1] + 1000};
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  std::shuffle(triangles.begin(), triangles.end(), random);
  EXPECT_FALSE(atlas::find_overlap(triangles));
  for (int i = 0; i < 50; ++i) {
    std::uniform_int_distribution<std::int32_t> corner(0, 59999);
    const atlas::GridPoint p = {corner(random), corner(random)};
    triangles.push_back({p, {p[0] + 1, p[1]}, {p[0] + 1, p[1] + 1}});
    const auto pair = atlas::find_overlap(triangles);
    ASSERT_TRUE(pair);
    EXPECT_EQ(std::max(pair->first, pair->second), triangles.size() - 1);
    EXPECT_GT(common_area(triangles[pair->first], triangles[pair->second]), 0.1);
    triangles.pop_back();
  }
}

TEST(Overlap, SlackToleratesShallowOverlaps) {
  const atlas::GridTriangle low = {{{0, 0}, {1000, 0}, {0, 1000}}},
                            high = {{{997, 0}, {1997, 1000}, {997, 1000}}};
  const std::array pair = {low, high};
  EXPECT_TRUE(atlas::find_overlap(pair));
  EXPECT_FALSE(atlas::find_overlap(pair, 4));
}

}  // namespace
}  // namespace sdm::atlas
