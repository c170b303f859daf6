// The closest point of a triangle in all its regions, of all shapes, against exact arithmetic.
#include "geometry/point_triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/triangle_regions.h"
#include "support/hausdorff_oracle.h"

namespace sdm {
namespace {

TEST(PointTriangle, EveryRegion) {
  for (const test::Shape& shape : test::kShapes) {
    if (!shape.flat) continue;
    SCOPED_TRACE(shape.name);
    test::for_each_placement(shape.corners, [](const Corners& t) {
      for (const test::RegionPoint& at : test::points_in_regions(t)) {
        // The thinnest of these triangles is a thousand times longer than wide.
        const double rounding = 1e-12 * test::largest_coordinate(t, at.p);
        const ClosestFeature found = closest_feature(at.p, t, /*flat=*/true);
        ASSERT_EQ(found.feature, at.feature) << at.index;
        if (found.feature != TriangleFeature::interior) {
          ASSERT_EQ(found.index, at.index);
        }
        if (found.feature == TriangleFeature::corner) {
          ASSERT_EQ(found.point, t[at.index]);
        }
        ASSERT_LE(norm(found.point - at.closest), rounding);
        ASSERT_EQ(found.squared, squared_norm(found.point - at.p));
        ASSERT_LE(norm(closest_on_triangle(at.p, t) - at.closest), rounding);
      }
    });
  }
}

// Around degenerate triangles as well, and in points where several regions meet.
TEST(PointTriangle, DistancesAreExactToRounding) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const test::Shape& shape : test::kShapes) {
    SCOPED_TRACE(shape.name);
    test::for_each_placement(shape.corners, [&](const Corners& t) {
      const double size = std::max(norm(t[1] - t[0]), norm(t[2] - t[0]));
      for (int i = 0; i < 300; ++i) {
        Vec3 p =
            t[i % 3] + (i % 4 == 0 ? 1e-6 : 2) * size * Vec3{normal(random), normal(random), normal(random)};
        if (i % 5 == 0) p = t[i % 3];
        if (i % 5 == 1) p = 0.5 * (t[i % 3] + t[(i + 1) % 3]);
        const double truth = oracle::exact_distance(p, t), rounding = 4e-15 * test::largest_coordinate(t, p);
        const double found = norm(closest_on_triangle(p, t) - p);
        ASSERT_NEAR(found, truth, rounding);
        const double by_feature = std::sqrt(closest_feature(p, t, shape.flat).squared);
        ASSERT_NEAR(by_feature, truth, shape.flat ? 1e3 * rounding : rounding + 1e-15 * size);
        if (i % 5 == 0) {
          ASSERT_EQ(found, 0);
          ASSERT_EQ(by_feature, 0);
        }
      }
    });
  }
}

// Closed meshes rely on it: a point in the plane of a face has distance 0, not a rounding error.
TEST(PointTriangle, PointsOfThePlaneAreExactlyOnTheFace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.1, 0.4);
  const Corners t{{{0.1, 0.2, 0.3}, {1.7, 0.1, 0.3}, {0.4, 2.3, 0.3}}};
  for (int i = 0; i < 1000; ++i) {
    const double v = u(random), w = u(random);
    Vec3 p = (1 - v - w) * t[0] + v * t[1] + w * t[2];
    p[2] = 0.3;
    EXPECT_EQ(closest_feature(p, t, true).squared, 0);
  }
}

}  // namespace
}  // namespace sdm
