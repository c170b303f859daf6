#include "atlas/charts/normal_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sdm {
namespace {

std::vector<Vec3> normals_near(const Vec3& axis, double angle, std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3> normals;
  while (normals.size() < count) {
    const Vec3 n = normalized({unit(random), unit(random), unit(random)});
    if (dot(n, axis) >= std::cos(angle)) normals.push_back(n);
  }
  return normals;
}

double widest(const std::vector<Vec3>& normals, const Vec3& axis) {
  double least = 1;
  for (const Vec3& n : normals) least = std::min(least, dot(n, axis));
  return std::acos(least);
}

TEST(NormalCone, JoinContainsAllNormals) {
  std::mt19937 random(4);
  int joined = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 first = normals_near({0, 0, 1}, 3, 1, random)[0];
    const Vec3 second = normals_near(first, 1.2, 1, random)[0];
    std::vector<Vec3> a = normals_near(first, 0.3, 1 + i % 40, random);
    const std::vector<Vec3> b = normals_near(second, 0.3, 1 + i % 7, random);
    const auto cone = join(atlas::spanned_cone(a, first), atlas::spanned_cone(b, second), std::cos(0.6));
    a.insert(a.end(), b.begin(), b.end());
    EXPECT_TRUE(!cone || widest(a, cone->axis) <= 0.6 + 1e-7);
    // Two caps of 0.3 whose centres are no farther apart than 0.4 lie in one of 0.5.
    EXPECT_TRUE(cone || dot(first, second) < std::cos(0.4));
    joined += cone.has_value();
  }
  EXPECT_GT(joined, 200);
  EXPECT_LT(joined, 1990);
}

TEST(NormalCone, KeepsFewRaysOfMany) {
  std::mt19937 random(5);
  const auto normals = normals_near({0, 0.6, 0.8}, 0.5, 5000, random);
  const atlas::NormalCone cone = atlas::spanned_cone(normals, {0, 0.6, 0.8});
  EXPECT_LT(cone.rays.size(), 100u);
  EXPECT_LE(widest(normals, cone.axis), widest(normals, {0, 0.6, 0.8}));
  EXPECT_NEAR(widest(normals, cone.axis), widest(cone.rays, cone.axis), 1e-12);
}

// Rays at the same place of the projection, and the corners of its hull, are chosen by their values.
TEST(NormalCone, DoesNotDependOnTheOrderOfNormals) {
  std::mt19937 random(6);
  const Vec3 axis = normalized({1, 2, 3});
  for (const std::size_t count : {7u, 300u}) {
    std::vector<Vec3> normals = normals_near(axis, 0.5, count, random);
    for (std::size_t i = 0; i < count; ++i)
      normals.push_back((1 + 1e-3 * static_cast<double>(i)) * normals[i]);
    const atlas::NormalCone cone = atlas::spanned_cone(normals, axis);
    for (int k = 0; k < 10; ++k) {
      std::ranges::shuffle(normals, random);
      const atlas::NormalCone again = atlas::spanned_cone(normals, axis);
      EXPECT_EQ(again.rays, cone.rays);
      EXPECT_EQ(again.axis, cone.axis);
    }
  }
}

}  // namespace
}  // namespace sdm
