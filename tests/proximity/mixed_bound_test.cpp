// Bounds on the smallest of several functions over a triangle, and the distances that they are made from.
#include "certify/depth/mixed_bound.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "certify/depth/face_distances.h"
#include "geometry/vec.h"
#include "sites/closest_on_face.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::depth {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

double largest(const CornerValues& values) {
  return *std::ranges::max_element(values);
}

// Linear functions, at many points of the triangle. The bound is the largest value itself, at the weights.
TEST(MixedBound, IsAboveTheSmallestFunctionEverywhere) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform;
  int smaller = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<CornerValues> functions(1 + trial % 6);
    for (CornerValues& values : functions)
      for (double& value : values) value = trial % 7 == 0 ? std::floor(3 * uniform(random)) : uniform(random);
    constexpr int kSteps = 40;
    double most = 0;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        double least = 1e9;
        for (const auto& [a, b, c] : functions)
          least = std::min(least, (i * a + j * b + (kSteps - i - j) * c) / kSteps);
        most = std::max(most, least);
      }
    const auto [bound, weights] = mixed_bound(functions, kNever);
    EXPECT_GE(bound, most - 1e-12);
    double best = 1e9;
    for (const CornerValues& values : functions) best = std::min(best, largest(values));
    EXPECT_LE(bound, best);
    double there = 1e9;  // at the weights
    for (const auto& [a, b, c] : functions)
      there = std::min(there, weights[0] * a + weights[1] * b + weights[2] * c);
    EXPECT_NEAR(bound, there, 1e-9);
    EXPECT_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-12);
    EXPECT_GE(*std::ranges::min_element(weights), 0);
    smaller += bound < best;
    if (functions.size() == 2) {
      EXPECT_NEAR(bound, most, 2.0 / kSteps);
    }
    EXPECT_EQ(mixed_bound(functions, best).value, best);  // is enough
  }
  EXPECT_GT(smaller, 500);
  EXPECT_EQ(mixed_bound({}, 0).value, std::numeric_limits<double>::infinity());
}

// Also of slivers, segments and points, in all regions around them.
TEST(FaceDistances, AreThoseOfClosestOnFace) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Mesh& mesh :
       {test::soup(60, random), test::degenerate_soup(60, 6), test::needles(1e-9), test::cube()}) {
    const Sites o2(mesh);
    const sites::SitesData& sites = internals(o2);
    for (int trial = 0; trial < 500; ++trial) {
      const auto face = [&] { return static_cast<std::uint32_t>(random() % mesh.triangles.size()); };
      const std::array faces{face(), face()};
      std::array<Vec3, 4> points;
      for (Vec3& p : points) p = {normal(random), normal(random), normal(random)};
      points[3] = mesh.positions[mesh.triangles[faces[0]][1]];
      const auto distances = face_distances(sites, points, faces);
      for (int f = 0; f < 2; ++f)
        for (int i = 0; i < 4; ++i)
          EXPECT_NEAR(distances[f][i], sites::closest_on_face(sites, faces[f], points[i]).distance, 1e-12);
    }
  }
}

}  // namespace
}  // namespace sdm::depth
