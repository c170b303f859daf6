// A line and a triangle, against rational arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "geometry/line_triangle.h"
#include "support/every_case.h"
#include "support/ray_oracle.h"

namespace sdm {
namespace {

/// Compares the part of the line with t ≥ 0.
void expect_agreement(const Vec3& origin, const Vec3& direction, const Corners& corners) {
  SCOPED_TRACE(testing::PrintToString(origin) + testing::PrintToString(direction) +
               testing::PrintToString(corners));
  auto hit = line_meets_triangle(origin, direction, corners);
  if (hit && hit->last < 0) hit.reset();
  const auto expected = oracle::ray_in_triangle(origin, direction, corners);
  ASSERT_EQ(hit.has_value(), expected.has_value());
  if (!hit) return;
  double farthest = 0;
  for (const Vec3& p : corners) farthest = std::max(farthest, norm(p - origin));
  const double tolerance = 1e-11 * farthest / norm(direction);
  EXPECT_NEAR(std::max(0.0, hit->first), expected->first, tolerance);
  EXPECT_NEAR(hit->last, expected->last, tolerance);
}

// On a small grid most cases are degenerate: lines through corners and edges, in the plane, along edges,
// triangles that are segments or points.
TEST(LineTriangle, AgreesWithRationalsOnAGrid) {
  std::mt19937 random(1);
  for (const int size : {1, 2, 5}) {
    std::uniform_int_distribution<int> grid(-size, size);
    const auto point = [&] { return Vec3{1.0 * grid(random), 1.0 * grid(random), 1.0 * grid(random)}; };
    for (std::size_t i = 0; i < test::subset(3000, 20000); ++i) {
      Vec3 direction = point();
      while (direction == Vec3{}) direction = point();
      expect_agreement(point(), direction, {point(), point(), point()});
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(LineTriangle, AgreesWithRationalsNearDegeneracy) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&] { return Vec3{u(random), u(random), u(random)}; };
  for (std::size_t i = 0; i < test::subset(3000, 20000); ++i) {
    const double near = std::pow(10.0, -8 + 8 * u(random));  // 1e-16 to 1
    const Vec3 a = point(), b = point();
    Vec3 c = i % 2 == 0 ? point() : a + u(random) * (b - a) + near * point();
    // To a point near the border or inside, or nearly in the plane.
    const Vec3 origin = i % 3 == 0 ? a + u(random) * (b - a) + u(random) * (c - a) + near * point() : point();
    const Vec3 to =
        a + 0.5 * (1 + u(random)) * (b - a) + (i % 5 == 0 ? u(random) : near * u(random)) * (c - a);
    if (to == origin) continue;
    expect_agreement(origin, to - origin, {a, b, c});
    if (testing::Test::HasFailure()) return;
  }
}

// Lines through a corner of several triangles, along an axis and not.
TEST(LineTriangle, TrianglesAtACornerHaveOneParameterThere) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 corner{u(random), u(random), u(random)};
    Vec3 origin = corner, direction{};
    const auto axis = static_cast<std::size_t>(i % 3);
    origin[axis] += u(random);
    direction[axis] = u(random) > 0 ? 1 : -3;
    if (i % 4 == 0) {  // along a diagonal, of numbers with few digits
      origin = {1, 2, 3};
      direction = {1, -1, 2};
    }
    const Vec3 at = i % 4 == 0 ? origin + static_cast<double>(i % 16 + 1) * direction : corner;
    std::optional<double> first;
    for (int k = 0; k < 6; ++k) {
      const auto hit = line_meets_triangle(
          origin, direction,
          {at, at + Vec3{u(random), u(random), u(random)}, at + Vec3{u(random), u(random), u(random)}});
      ASSERT_TRUE(hit);
      ASSERT_EQ(hit->first, hit->last);
      if (!first) first = hit->first;
      ASSERT_EQ(hit->first, *first);
    }
    ASSERT_NEAR(norm(origin + *first * direction - at), 0, 1e-14);
  }
}

TEST(LineTriangle, AgreesWithRationalsAtExtremeMagnitudes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  std::uniform_int_distribution<int> exponent(-120, 120);
  const auto point = [&](int e) {
    return Vec3{std::ldexp(u(random), e), std::ldexp(u(random), e), std::ldexp(u(random), e)};
  };
  for (std::size_t i = 0; i < test::subset(1000, 3000); ++i) {
    const int e = exponent(random), other = exponent(random);
    const Vec3 origin = point(i % 2 == 0 ? e : other), a = point(e), b = point(e), c = point(e);
    const Vec3 to = a + 0.3 * (b - a) + 0.3 * (c - a);
    if (to == origin) continue;
    expect_agreement(origin, std::ldexp(1.0, exponent(random) / 2) * (to - origin), {a, b, c});
    expect_agreement(origin, point(exponent(random) / 2), {a, b, c});
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace sdm
