// Two triangles of every kind against exact arithmetic.
#include "geometry/triangle_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/point_triangle.h"
#include "geometry/predicates.h"
#include "geometry/vec.h"
#include "support/pair_oracle.h"

namespace sdm::pairs {
namespace {

Vec3 grid_point(std::mt19937& random, int side) {
  std::uniform_int_distribution<int> at(0, side - 1);
  return {double(at(random)), double(at(random)), double(at(random))};
}

Corners grid_triangle(std::mt19937& random, int side) {
  return {grid_point(random, side), grid_point(random, side), grid_point(random, side)};
}

Corners in_cube(std::mt19937& random, double side, const Vec3& middle) {
  std::uniform_real_distribution<double> at(-side, side);
  Corners t;
  for (Vec3& p : t) p = middle + Vec3{at(random), at(random), at(random)};
  return t;
}

double largest(const Corners& a, const Corners& b) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    extend(box, a[k]);
    extend(box, b[k]);
  }
  return diagonal(box);
}

double distance_from(const Vec3& point, const Corners& t) {
  return oracle::distance({point, point, point}, t);
}

void expect_right(const Corners& a, const Corners& b) {
  const bool intersecting = oracle::intersect(a, b);
  ASSERT_EQ(triangles_intersect(a, b), intersecting);
  ASSERT_EQ(triangles_intersect(b, a), intersecting);
  const double tolerance = 1e-14 * largest(a, b);
  if (intersecting) {
    const Vec3 p = common_point(a, b);
    EXPECT_LE(distance_from(p, a), 1e3 * tolerance);
    EXPECT_LE(distance_from(p, b), 1e3 * tolerance);
    return;
  }
  const PointPair closest = closest_points(a, b);
  EXPECT_NEAR(std::sqrt(closest.squared), oracle::distance(a, b), tolerance);
  EXPECT_DOUBLE_EQ(closest.squared, squared_norm(closest.point2 - closest.point1));
  EXPECT_LE(distance_from(closest.point1, a), tolerance);
  EXPECT_LE(distance_from(closest.point2, b), tolerance);
}

// On a small grid triangles touch in all ways, lie in one plane, and are segments and points often.
TEST(TrianglePair, OnAGrid) {
  std::mt19937 random(1);
  int intersecting = 0, degenerate = 0;
  for (int i = 0; i < 6000; ++i) {
    const int side = 2 + i % 4;
    const Corners a = grid_triangle(random, side), b = grid_triangle(random, side);
    SCOPED_TRACE(i);
    expect_right(a, b);
    if (HasFatalFailure()) return;
    intersecting += triangles_intersect(a, b);
    degenerate += cross(a[1] - a[0], a[2] - a[0]) == Vec3{};
  }
  EXPECT_GT(intersecting, 1000);
  EXPECT_GT(degenerate, 500);
}

// In one plane, slanted or not: side by side, across each other, and one within the other.
TEST(TrianglePair, Coplanar) {
  std::mt19937 random(4);
  for (int i = 0; i < 2000; ++i) {
    Corners a = grid_triangle(random, 12), b = grid_triangle(random, 5);
    for (int k = 0; k < 3; ++k) {
      a[k][2] = i % 2 ? 2 * a[k][0] - a[k][1] : 1;
      b[k] = {b[k][0] + 3, b[k][1] + 3, 1};
      if (i % 2) b[k][2] = 2 * b[k][0] - b[k][1];
    }
    SCOPED_TRACE(i);
    expect_right(a, b);
    if (HasFatalFailure()) return;
  }
}

TEST(TrianglePair, AnySizeAndPlace) {
  std::mt19937 random(2);
  for (int i = 0; i < 1500; ++i) {
    const double size = std::pow(10.0, -3 + i % 7), apart = size * (i % 5);
    SCOPED_TRACE(i);
    expect_right(in_cube(random, size, {}), in_cube(random, size, {apart, 0, 0}));
    expect_right(in_cube(random, size, {}), in_cube(random, 1e-6 * size, {apart, 0, 0}));
    if (HasFatalFailure()) return;
  }
}

// Needles: a corner almost on the opposite side, or two almost the same.
TEST(TrianglePair, Needles) {
  std::mt19937 random(3);
  for (int i = 0; i < 1500; ++i) {
    const double height = std::pow(10.0, -(i % 16));
    Corners a = in_cube(random, 1, {}), b = in_cube(random, 1, {0.5, 0, 0});
    a[2] = (i % 2 ? 0.5 : 1.0) * a[0] + (i % 2 ? 0.5 : 0.0) * a[1] + height * a[2];
    b[2] = 0.25 * b[0] + 0.75 * b[1] + height * b[2];
    SCOPED_TRACE(i);
    expect_right(a, b);
    if (HasFatalFailure()) return;
  }
}

// Edges that are parallel but for a tiny angle cross each other at a tiny height.
TEST(TrianglePair, NearlyParallelEdges) {
  for (int power = 1; power < 16; ++power) {
    const double angle = std::pow(10.0, -power);
    for (const double height : {1e-3, 1e-9, 1e-15}) {
      SCOPED_TRACE(testing::Message() << angle << ' ' << height);
      expect_right({{{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}}},
                   {{{-1, -angle / 3, height}, {1, angle, height}, {0, 0, 1}}});
    }
  }
}

// A corner is moved through the other triangle by single units in the last place: each step is decided.
TEST(TrianglePair, DecidesDifferencesOfOneUlp) {
  const Corners a{{{0.1, 0.2, 0.3}, {1.3, 0.7, 0.6}, {0.4, 1.1, 0.2}}};
  const Vec3 inside = (1.0 / 3) * (a[0] + a[1] + a[2]);
  int sides = 0;
  for (int step = -20; step <= 20; ++step) {
    Corners b{{inside, inside + Vec3{0.1, 0.1, 1}, inside + Vec3{-0.1, 0.2, 1}}};
    b[0][2] += step * 5e-17;
    ASSERT_EQ(triangles_intersect(a, b), oracle::intersect(a, b)) << step;
    sides |= triangles_intersect(a, b) ? 1 : 2;
  }
  EXPECT_EQ(sides, 3);
}

// The point that common_point() describes, found without leaving out any pair of features.
Vec3 common_point_of_all_features(const Corners& a, const Corners& b) {
  const TriangleSides sides[2] = {TriangleSides(a), TriangleSides(b)};
  PointPair crossing{std::numeric_limits<double>::infinity(), {}, {}};
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) {
      const TriangleSides &edges = sides[i], &face = sides[1 - i];
      const double t = dot(face.corner[0] - edges.corner[k], face.normal) / dot(edges.side[k], face.normal);
      const Vec3 point = edges.corner[k] + t * edges.side[k];
      Vec3 foot;
      if (!(t >= 0 && t <= 1) || !face.over(point, foot)) continue;
      if (const double squared = squared_norm(foot - point); squared < crossing.squared)
        crossing = {squared, point, foot};
    }
  const PointPair best = closest_points(a, b);
  return crossing.squared < best.squared ? crossing.point1 : best.point1;
}

// Pairs of features that are certainly farther apart than an edge is from the triangle that it crosses are
// left out. A corner or a side within rounding of the other triangle must not be.
TEST(TrianglePair, CommonPointsAreThoseOfAllFeatures) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> at(0, 1);
  int intersecting = 0;
  const auto compare = [&](const Corners& a, const Corners& b) {
    if (!triangles_intersect(a, b)) return;
    ++intersecting;
    ASSERT_EQ(common_point(a, b), common_point_of_all_features(a, b));
    ASSERT_EQ(common_point(b, a), common_point_of_all_features(b, a));
  };
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    const Vec3 far{std::pow(10.0, i % 5) - 1, 0, 0};
    const Corners a = in_cube(random, 1, far);
    Corners b = in_cube(random, 1, far);
    compare(a, b);
    // A corner barely beyond the other triangle, or below its side.
    const double s = at(random), t = at(random) * (1 - s), height = std::pow(10.0, -8 - i % 10);
    const Vec3 inside = a[0] + s * (a[1] - a[0]) + t * (a[2] - a[0]), on_side = a[0] + s * (a[1] - a[0]);
    b[0] = (i % 3 == 0 ? on_side : inside) + height * in_cube(random, 1, {})[0];
    compare(a, b);
    // A side that crosses one of the other triangle nearly.
    b[1] = on_side + (on_side - b[0]) + height * in_cube(random, 1, {})[0];
    compare(a, b);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(intersecting, 10000);
}

TEST(TrianglePair, ExtremeCoordinates) {
  const Corners shape{{{1, 2, 3}, {4, 1, 2}, {2, 5, 1}}}, other{{{2, 2, 2.1}, {2, 3, 9}, {3, 2, 8}}};
  for (const double scale : {1e-60, 1e-30, 1e36}) {
    Corners a = shape, b = other;
    for (int k = 0; k < 3; ++k) {
      a[k] = scale * a[k];
      b[k] = scale * b[k];
    }
    SCOPED_TRACE(scale);
    EXPECT_EQ(triangles_intersect(a, b), triangles_intersect(shape, other));
    EXPECT_NEAR(std::sqrt(closest_points(a, b).squared) / scale,
                std::sqrt(closest_points(shape, other).squared), 1e-14);
  }
}

TEST(Orientation, IsExactWhereRoundingIsNot) {
  // Four points of a plane, and one of them off by the smallest number there is.
  const double third = 1.0 / 3, tiny = std::numeric_limits<double>::denorm_min();
  const Vec3 a{0, 0, 0}, b{third, 0.1, 0}, c{0.7, third, 0};
  EXPECT_EQ(orientation(a, b, c, Vec3{0.3, 0.9, 0}), 0);
  EXPECT_EQ(orientation(a, b, c, Vec3{0.3, 0.9, tiny}), 1);
  EXPECT_EQ(orientation(a, b, c, Vec3{0.3, 0.9, -tiny}), -1);
  EXPECT_EQ(orientation(Vec2{0, 0}, Vec2{third, third}, Vec2{1e30, 1e30}), 0);
  EXPECT_EQ(orientation(Vec2{0, 0}, Vec2{1e30, 1e30}, Vec2{third, std::nextafter(third, 1)}), 1);
}

// Points almost on a line and almost in a plane. For any order of the corners and any power of
// two; naive evaluation would round and underflow.
TEST(Orientation, IsConsistentUnderPermutationAndScaling) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(0.5, 1);
  const double small = std::ldexp(1, -350);
  for (int i = 0; i < 2000; ++i) {
    const double x = at(random), y = at(random), slope = at(random);
    const Vec2 a{x, slope * x}, b{y, slope * y}, c{0.25 * x, 0.25 * (slope * x)};
    ASSERT_EQ(orientation(a, b, c), orientation(b, c, a));
    ASSERT_EQ(orientation(a, b, c), orientation(c, a, b));
    ASSERT_EQ(orientation(a, b, c), -orientation(b, a, c));
    ASSERT_EQ(orientation(a, b, c), orientation(small * a, small * b, small * c));
    const Vec3 p{x, y, slope}, q{at(random), at(random), at(random)}, r{at(random), at(random), at(random)},
        s = q + r - p;
    const int sign = orientation(p, q, r, s);
    ASSERT_EQ(sign, -orientation(s, q, r, p));
    ASSERT_EQ(sign, -orientation(q, r, s, p));
    ASSERT_EQ(sign, orientation(small * p, small * q, small * r, small * s));
  }
}

}  // namespace
}  // namespace sdm::pairs
