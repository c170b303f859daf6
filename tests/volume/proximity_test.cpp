// Distances between the points of a grid, and proximity from a field, within their bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include "support/error_of.h"
#include "support/oracle.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_points(const Box& box, std::size_t count) {
  std::mt19937 random(11);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution(box.lo[k], box.hi[k])(random);
  return points;
}

TEST(FieldSamples, HaveBoundsThatHold) {
  for (const FieldScene& scene : field_scenes())
    for (const double band : {kInfinity, 0.05 * diagonal_of(scene)}) {
      SCOPED_TRACE(scene.name + ", band " + std::to_string(band));
      const DistanceField field = compute_field(Sites(scene.mesh), scene.grid, {.band = band});
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

struct Pose {
  std::string name;
  Vec3 offset;
};

TEST(FieldProximityBounds, HoldForTheSurfaces) {
  const Mesh o2 = ring(24), ball = placed(sphere(2), "scale:0.35");
  const Grid grid = make_grid(around(o2, 0.3), {40, 40, 24});
  for (const double band : {kInfinity, 0.15})
    for (const Pose& pose : {Pose{"apart", {0, 0, 1.2}}, Pose{"in_the_hole", {0, 0, 0}},
                             Pose{"touching", {0, 0.3, 0.4}}, Pose{"penetrating", {0.8, 0.1, 0.1}},
                             Pose{"within", {1, 0, 0}}, Pose{"outside_the_grid", {4, 4, 4}}}) {
      SCOPED_TRACE(pose.name + ", band " + std::to_string(band));
      const Mesh o1 = moved(pose.name == "within" ? placed(sphere(2), "scale:0.1") : ball, pose.offset);
      const DistanceField field = compute_field(Sites(o2), grid, {.band = band});
      const FieldProximity found = field_proximity(field, o1);
      ProximityQuery exact(o1, o2);
      const BoundedLength separation = exact.separation();
      EXPECT_LE(found.separation.lower, separation.upper + 1e-9);
      EXPECT_GE(found.separation.upper, separation.lower - 1e-9);
      const auto reach = [&](const Vec3& p) {
        const double d = oracle::brute_force(o2, p);
        return oracle::winding_number(o2, p) != 0 ? d : 0;
      };
      double deepest = 0;
      for (const Vec3& p : o1.positions) deepest = std::max(deepest, reach(p));
      ASSERT_TRUE(found.depth);
      EXPECT_GE(found.depth->upper, deepest - 1e-9);
      EXPECT_LE(found.depth->lower, deepest + found.covering_radius + 1e-9);
      if (found.colliding.certainty == Certainty::exact) {
        EXPECT_EQ(found.colliding.value, exact.colliding().value);
      }
      if (found.without_value == 0) {
        EXPECT_NEAR(found.separation.value, separation.value, found.error_bound);
        EXPECT_NEAR(found.depth->value, deepest, found.error_bound);
      }
      if (band == kInfinity &&
          (pose.name == "apart" || pose.name == "within" || pose.name == "outside_the_grid")) {
        EXPECT_EQ(found.colliding.certainty, Certainty::exact);
      }
    }
}

TEST(FieldProximityBounds, GetCloserWithTheGrid) {
  const Mesh o2 = ring(24), o1 = moved(sphere(2), {0, 0, 2});
  double before = kInfinity;
  for (const std::uint32_t n : {10u, 20u, 40u}) {
    const Grid grid = make_grid({{-2, -2, -1}, {2, 2, 3.2}}, {n, n, n});
    const FieldProximity found = field_proximity(compute_field(Sites(o2), grid), o1);
    EXPECT_LT(found.separation.upper - found.separation.lower, 0.7 * before);
    before = found.separation.upper - found.separation.lower;
  }
}

TEST(FieldProximityBounds, OfUnsignedFields) {
  const Mesh open = height_field(6);
  const Box box = around(open, 0.5);
  const DistanceField field = compute_field(Sites(open), make_grid(box, {24, 24, 24}));
  const Box b = bounds(open);
  const Mesh above = moved(placed(sphere(1), "scale:0.05"), {0.5, 0.5, b.hi[2] + 0.3});
  FieldProximity found = field_proximity(field, above);
  EXPECT_FALSE(found.depth);
  EXPECT_FALSE(found.colliding.value);
  EXPECT_EQ(found.colliding.certainty, Certainty::exact);
  found = field_proximity(field, open);
  EXPECT_TRUE(found.colliding.value);
  EXPECT_EQ(found.colliding.certainty, Certainty::estimate);
}

TEST(FieldProximityBounds, OfWrongInputAreErrors) {
  const DistanceField field = compute_field(Sites(cube()), make_grid({{-2, -2, -2}, {2, 2, 2}}, {5, 5, 5}));
  EXPECT_THAT(error_of([&] { return field_proximity(field, Mesh{}); }), HasSubstr("no triangles"));
  EXPECT_THAT(error_of([&] { return field_proximity(field, cube(), {.sample_spacing = -1}); }),
              HasSubstr("negative"));
  EXPECT_THAT(error_of([&] { return field_proximity(field, cube(), {.sample_spacing = 1e-9}); }),
              HasSubstr("10^10"));
  FieldProximityOptions cancelled;
  cancelled.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)field_proximity(field, cube(), cancelled), Cancelled);
}

}  // namespace
}  // namespace sdm::test
