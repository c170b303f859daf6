// The distances of triangles in lanes, of all shapes, with every set of vector instructions.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/triangle_pair_lanes_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <utility>
#include <vector>

#include "geometry/lanes/triangle_pair-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::test::HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;

void SquaredDistances(const std::vector<std::pair<Corners, Corners>>& pairs, std::vector<double>& found) {
  for (size_t first = 0; first < pairs.size(); first += kLanes) {
    const size_t count = pairs.size() - first < kLanes ? pairs.size() - first : kLanes;
    TrianglePairs lanes;
    for (size_t i = 0; i < count; ++i) lanes.set(i, pairs[first + i].first, pairs[first + i].second);
    double squared[kLanes];
    lanes.squared_distances(count, squared);
    found.insert(found.end(), squared, squared + count);
  }
}

}  // namespace sdm::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/triangle_pair.h"
#include "geometry/triangle_regions.h"
#include "support/pair_oracle.h"
#include "support/simd_targets.h"

namespace sdm::test {
namespace {

HWY_EXPORT(SquaredDistances);

TEST(TrianglePairLanes, AreTheDistancesOnEveryTarget) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<std::pair<Corners, Corners>> pairs;
  std::vector<double> truth;
  for (const Shape& one : kShapes)
    for (const Shape& other : kShapes)
      for_each_placement(other.corners, [&](const Corners& placed) {
        const Vec3 move{2 * normal(random), 2 * normal(random), 2 * normal(random)};
        Corners a = one.corners;
        for (Vec3& p : a) p = p + move;
        if (triangles_intersect(a, placed)) return;
        pairs.emplace_back(a, placed);
        truth.push_back(oracle::distance(a, placed));
      });
  ASSERT_GT(pairs.size(), 400);
  for (const SimdTarget target : simd_targets()) {
    const UseSimdTarget use(target);
    SCOPED_TRACE(name(target));
    std::vector<double> found;
    HWY_DYNAMIC_DISPATCH(SquaredDistances)(pairs, found);
    ASSERT_EQ(found.size(), pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto& [a, b] = pairs[i];
      const double largest = std::max(largest_coordinate(a, a[0]), largest_coordinate(b, b[0]));
      EXPECT_NEAR(std::sqrt(found[i]), truth[i], 1e-14 * largest) << i;
    }
  }
}

}  // namespace
}  // namespace sdm::test
#endif
