#include "geometry/clip.h"

#include <gtest/gtest.h>
#include <sdm/types.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace sdm {
namespace {

using Polygon = std::vector<Vec2>;

struct Line {
  Vec2 normal;
  double offset;

  [[nodiscard]] double height(const Vec2& p) const { return dot(normal, p) - offset; }
};

Polygon clip(const Polygon& polygon, const Line& line) {
  std::vector<double> height;
  for (const Vec2& p : polygon) height.push_back(line.height(p));
  Polygon part;
  clip_convex(
      height, [&](std::size_t i) { part.push_back(polygon[i]); },
      [&](std::size_t i, std::size_t j, double t) {
        part.push_back(polygon[i] + t * (polygon[j] - polygon[i]));
      });
  return part;
}

double area(const Polygon& polygon) {
  double doubled = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    doubled += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * doubled;
}

TEST(ClipConvex, DividesTheAreaAmongBothSides) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int run = 0; run < 1000; ++run) {
    Polygon polygon;
    const int corners = 3 + run % 8;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.4 * number(random)) / corners;
      polygon.push_back({std::cos(angle), std::sin(angle)});
    }
    const double turn = std::numbers::pi * number(random);
    const Line line{{std::cos(turn), std::sin(turn)}, number(random)};
    const Polygon above = clip(polygon, line), below = clip(polygon, {-1.0 * line.normal, -line.offset});
    EXPECT_NEAR(area(above) + area(below), area(polygon), 1e-12);
    EXPECT_LE(above.size(), polygon.size() + 1);
    for (const Vec2& p : above) EXPECT_GE(line.height(p), -1e-12);
    for (const Vec2& p : below) EXPECT_LE(line.height(p), 1e-12);
  }
}

// The corners of a square against lines through some of them.
TEST(ClipConvex, KeepsACornerOnTheLineOnce) {
  const Polygon square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(clip(square, {{0, 1}, 0}), square);                                // along a side
  EXPECT_EQ(clip(square, {{0, -1}, 0}), (Polygon{{0, 0}, {1, 0}}));            // a side is what remains
  EXPECT_EQ(clip(square, {{-1, -1}, 0}), (Polygon{{0, 0}}));                   // a corner is
  EXPECT_EQ(clip(square, {{1, -1}, 0}), (Polygon{{0, 0}, {1, 0}, {1, 1}}));    // along a diagonal
  EXPECT_EQ(clip(square, {{1, -2}, 0}), (Polygon{{0, 0}, {1, 0}, {1, 0.5}}));  // through one corner
  EXPECT_EQ(clip(square, {{1, 0}, 2}), Polygon{});
  EXPECT_EQ(clip({}, {{1, 0}, 2}), Polygon{});
}

}  // namespace
}  // namespace sdm
