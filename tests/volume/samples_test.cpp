// Distances between the points of a grid, within their bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include "support/error_of.h"
#include "support/oracle.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

std::vector<Vec3> random_points(const Box& box, std::size_t count) {
  std::mt19937 random(11);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution(box.lower[k], box.upper[k])(random);
  return points;
}

TEST(FieldSamples, HaveBoundsThatHold) {
  for (const FieldScene& scene : field_scenes())
    for (const double band : {kInfinity, 0.05 * diagonal_of(scene)}) {
      SCOPED_TRACE(scene.name + ", band " + std::to_string(band));
      const DistanceField field = compute_field(Sites(scene.mesh), scene.grid, {.max_distance = band});
      const bool is_signed = field.sign.method == SignMethod::exact;
      Box box = bounds(scene.mesh);  // parts of it are outside of some grids, as is some of the grid of it
      extend(box, scene.grid.origin);
      const std::vector<Vec3> points = random_points(box, 25);
      const std::vector<FieldSample> samples = sample_field(field, points);
      const double rounding = 1e-12 * diagonal_of(scene);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double d = oracle::brute_force(scene.mesh, points[i]);
        const double truth = is_signed && oracle::winding_number(scene.mesh, points[i]) != 0 ? -d : d;
        EXPECT_LE(samples[i].lower, truth + rounding);
        EXPECT_GE(samples[i].upper, truth - rounding);
        EXPECT_LE(samples[i].magnitude, d + rounding);
        if (!std::isnan(samples[i].value)) {
          EXPECT_NEAR(samples[i].value, truth, interpolation_error(scene.grid) + field.accuracy);
        }
      }
    }
}

TEST(FieldSamples, AtPointsOfTheGridAreItsValues) {
  const FieldScene scene = field_scenes()[0];
  const DistanceField field = compute_field(Sites(scene.mesh), scene.grid);
  for_some_points(scene.grid, 100, [&](std::size_t i, const Vec3& p) {
    const FieldSample sample = sample_field(field, std::vector{p})[0];
    EXPECT_NEAR(sample.value, field.distance[i], 1e-6);
    EXPECT_NEAR(sample.upper - sample.lower, 2 * field.accuracy, 1e-9);
  });
}

TEST(FieldSamples, OutsideOfTheGridHaveBoundsOnly) {
  const DistanceField field = compute_field(Sites(cube()), make_grid({{-2, -2, -2}, {2, 2, 2}}, {9, 9, 9}));
  const FieldSample sample = sample_field(field, std::vector{Vec3{5, 0, 0}})[0];
  EXPECT_TRUE(std::isnan(sample.value));
  EXPECT_EQ(sample.lower, 4) << "from O2's box";
  EXPECT_NEAR(sample.upper, 4, 1e-5);
}

TEST(FieldSamples, WithoutASignOfTheirOwnHaveBoundsForBoth) {
  const Mesh open = height_field(6);
  const Grid grid = make_grid(around(open, 0.3), {12, 12, 12});
  const DistanceField field = compute_field(Sites(open), grid, {.sign = SignMethod::winding});
  for (const FieldSample& s : sample_field(field, random_points(around(open, 0.3), 50)))
    EXPECT_EQ(s.lower, -s.upper);
}

TEST(FieldSamples, OfWrongInputAreErrors) {
  const Grid grid = make_grid({{-2, -2, -2}, {2, 2, 2}}, {3, 3, 3});
  DistanceField field = compute_field(Sites(cube()), grid);
  EXPECT_THAT(error_of([&] {
                return sample_field(field, std::vector{Vec3{kInfinity, 0, 0}});
              }),
              HasSubstr("point 0"));
  field.distance.pop_back();
  EXPECT_THAT(error_of([&] {
                return sample_field(field, std::vector{Vec3{0, 0, 0}});
              }),
              HasSubstr("26 distances for a grid of 27"));
}

}  // namespace
}  // namespace sdm::test
