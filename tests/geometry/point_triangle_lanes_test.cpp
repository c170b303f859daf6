// The distances of points and triangles in lanes: in all regions, of all shapes, in both precisions and with
// every set of vector instructions, against exact arithmetic.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/point_triangle_lanes_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <vector>

#include "geometry/lanes/point_triangle-inl.h"
#include "geometry/triangle.h"

#ifndef SDM_POINT_TRIANGLE_LANES_TEST
#define SDM_POINT_TRIANGLE_LANES_TEST
namespace sdm {

struct Pair {
  Vec3 p;
  Corners corners;
  bool flat;
};

// Squared distances.
struct Found {
  double any_shape, flagged;
};

}  // namespace sdm
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

template <class T, size_t width>
void Measure(const std::vector<Pair>& pairs, std::vector<Found>& found) {
  const hn::CappedTag<T, width> d;
  for (size_t first = 0; first < pairs.size(); first += width) {
    alignas(64) T point[3][width] = {}, corner[3][3][width] = {}, flat[width] = {}, any[width],
                  flagged[width];
    for (size_t i = 0; i < width && first + i < pairs.size(); ++i) {
      const Pair& pair = pairs[first + i];
      for (int k = 0; k < 3; ++k) {
        point[k][i] = static_cast<T>(pair.p[k]);
        for (int c = 0; c < 3; ++c) corner[c][k][i] = static_cast<T>(pair.corners[c][k]);
      }
      flat[i] = pair.flat ? 1 : 0;
    }
    for (size_t i = 0; i < width; i += hn::Lanes(d)) {
      const TriangleSides<decltype(d)> t(load(d, corner[0], i), load(d, corner[1], i), load(d, corner[2], i));
      const auto p = load(d, point, i);
      hn::Store(t.squared_distance(p), d, any + i);
      hn::Store(t.squared_distance(p, hn::Gt(hn::Load(d, flat + i), hn::Zero(d))), d, flagged + i);
    }
    for (size_t i = 0; i < width && first + i < pairs.size(); ++i) found.push_back({any[i], flagged[i]});
  }
}

void MeasureFloats(const std::vector<Pair>& pairs, std::vector<Found>& found) {
  Measure<float, 8>(pairs, found);
}
void MeasureDoubles(const std::vector<Pair>& pairs, std::vector<Found>& found) {
  Measure<double, 8>(pairs, found);
}
// Other widths than those in use.
void MeasureFew(const std::vector<Pair>& pairs, std::vector<Found>& found) {
  Measure<double, 2>(pairs, found);
}

}  // namespace sdm::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/triangle_regions.h"
#include "support/hausdorff_oracle.h"
#include "support/simd_targets.h"

namespace sdm::test {
namespace {

HWY_EXPORT(MeasureFloats);
HWY_EXPORT(MeasureDoubles);
HWY_EXPORT(MeasureFew);

enum class Precision { floats, doubles, few_doubles };

std::vector<Found> measure(const std::vector<Pair>& pairs, Precision precision) {
  std::vector<Found> found;
  switch (precision) {
    case Precision::floats:
      HWY_DYNAMIC_DISPATCH(MeasureFloats)(pairs, found);
      break;
    case Precision::doubles:
      HWY_DYNAMIC_DISPATCH(MeasureDoubles)(pairs, found);
      break;
    case Precision::few_doubles:
      HWY_DYNAMIC_DISPATCH(MeasureFew)(pairs, found);
  }
  return found;
}

Vec3 rounded(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// In all regions if there are any, and at random around degenerate triangles. In coordinates of single
// precision, so that only the distances are rounded.
std::vector<Pair> all_pairs() {
  std::vector<Pair> pairs;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const Shape& shape : kShapes)
    for_each_placement(shape.corners, [&](const Corners& placed) {
      const Corners t{rounded(placed[0]), rounded(placed[1]), rounded(placed[2])};
      const double size = std::max(norm(t[1] - t[0]), norm(t[2] - t[0]));
      if (shape.flat)
        for (const RegionPoint& at : points_in_regions(t)) pairs.push_back({rounded(at.p), t, true});
      for (int i = 0; i < 50; ++i) {
        const Vec3 beside{normal(random), normal(random), normal(random)};
        pairs.push_back({rounded(t[i % 3] + (i % 5 == 0 ? 0 : size) * beside), t, shape.flat});
      }
    });
  return pairs;
}

TEST(PointTriangleLanes, EveryRegionOnEveryTarget) {
  const std::vector<Pair> pairs = all_pairs();
  std::vector<double> truth;
  for (const Pair& pair : pairs) truth.push_back(oracle::exact_distance(pair.p, pair.corners));
  for (const SimdTarget target : simd_targets()) {
    const UseSimdTarget use(target);
    for (const Precision precision : {Precision::floats, Precision::doubles, Precision::few_doubles}) {
      SCOPED_TRACE(name(target) + (precision == Precision::floats ? " floats" : " doubles"));
      const double epsilon = precision == Precision::floats ? std::numeric_limits<float>::epsilon()
                                                            : std::numeric_limits<double>::epsilon();
      const std::vector<Found> found = measure(pairs, precision);
      ASSERT_EQ(found.size(), pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto& [p, t, flat] = pairs[i];
        const double rounding = 4 * epsilon * largest_coordinate(t, p);
        // Rounding the coordinates has made triangles of those without a width.
        const double width = flat ? 0
                                  : norm(cross(t[1] - t[0], t[2] - t[0])) /
                                        std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), 1e-300});
        const double any = std::sqrt(found[i].any_shape), flagged = std::sqrt(found[i].flagged);
        ASSERT_NEAR(flagged, truth[i], rounding + width) << i;
        ASSERT_GE(any, truth[i] - rounding) << i;
        // The foot may be off along a triangle that is a thousand times longer than wide.
        ASSERT_LE(any, truth[i] + (flat ? 1e3 * rounding : rounding + width)) << i;
      }
    }
  }
}

// The squares of their sides and normals underflow in single precision.
TEST(PointTriangleLanes, TinyTriangles) {
  std::vector<Pair> pairs;
  for (const double size : {1e-6, 1e-9, 1e-12, 1e-15, 1e-20, 1e-30, 1e-40})
    for (const Vec3& p :
         {Vec3{0.3, 0.3, 1}, Vec3{0.25 * size, 0.25 * size, 1e-3}, Vec3{0, 0, size}, Vec3{-1, 0, 0}})
      pairs.push_back({p, {{{0, 0, 0}, {size, 0, 0}, {0, size, 0}}}, true});
  for (const SimdTarget target : simd_targets()) {
    const UseSimdTarget use(target);
    SCOPED_TRACE(name(target));
    const std::vector<Found> found = measure(pairs, Precision::floats);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double truth = oracle::exact_distance(pairs[i].p, pairs[i].corners);
      EXPECT_NEAR(std::sqrt(found[i].flagged), truth, 1e-6 * truth + 1e-18) << i;
      EXPECT_NEAR(std::sqrt(found[i].any_shape), truth, 1e-6 * truth + 1e-18) << i;
    }
  }
}

}  // namespace
}  // namespace sdm::test
#endif
