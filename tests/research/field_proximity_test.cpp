// Proximity from a field, within its bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include "research/fields/fields.h"
#include "support/error_of.h"
#include "support/oracle.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

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
      const DistanceField field = compute_field(Sites(o2), grid, {.max_distance = band});
      const fields::Proximity found = fields::proximity(field, o1);
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
      if (found.colliding_certainty == Certainty::exact) {
        EXPECT_EQ(found.colliding, exact.colliding());
      }
      if (found.without_value == 0) {
        EXPECT_NEAR(found.separation.value, separation.value, found.error_bound);
        EXPECT_NEAR(found.depth->value, deepest, found.error_bound);
      }
      if (band == kInfinity &&
          (pose.name == "apart" || pose.name == "within" || pose.name == "outside_the_grid")) {
        EXPECT_EQ(found.colliding_certainty, Certainty::exact);
      }
    }
}

TEST(FieldProximityBounds, GetCloserWithTheGrid) {
  const Mesh o2 = ring(24), o1 = moved(sphere(2), {0, 0, 2});
  double before = kInfinity;
  for (const std::uint32_t n : {10u, 20u, 40u}) {
    const Grid grid = make_grid({{-2, -2, -1}, {2, 2, 3.2}}, {n, n, n});
    const fields::Proximity found = fields::proximity(compute_field(Sites(o2), grid), o1);
    EXPECT_LT(found.separation.upper - found.separation.lower, 0.7 * before);
    before = found.separation.upper - found.separation.lower;
  }
}

TEST(FieldProximityBounds, OfUnsignedFields) {
  const Mesh open = height_field(6);
  const Box box = around(open, 0.5);
  const DistanceField field = compute_field(Sites(open), make_grid(box, {24, 24, 24}));
  const Box b = bounds(open);
  const Mesh above = moved(placed(sphere(1), "scale:0.05"), {0.5, 0.5, b.upper[2] + 0.3});
  fields::Proximity found = fields::proximity(field, above);
  EXPECT_FALSE(found.depth);
  EXPECT_FALSE(found.colliding);
  EXPECT_EQ(found.colliding_certainty, Certainty::exact);
  found = fields::proximity(field, open);
  EXPECT_TRUE(found.colliding);
  EXPECT_EQ(found.colliding_certainty, Certainty::estimate);
}

TEST(FieldProximityBounds, OfWrongInputAreErrors) {
  const DistanceField field = compute_field(Sites(cube()), make_grid({{-2, -2, -2}, {2, 2, 2}}, {5, 5, 5}));
  EXPECT_THAT(error_of([&] { return fields::proximity(field, Mesh{}); }), HasSubstr("no triangles"));
  EXPECT_THAT(error_of([&] { return fields::proximity(field, cube(), {.sample_spacing = -1}); }),
              HasSubstr("negative"));
  EXPECT_THAT(error_of([&] { return fields::proximity(field, cube(), {.sample_spacing = 1e-9}); }),
              HasSubstr("10^10"));
  fields::ProximityOptions cancelled;
  cancelled.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)fields::proximity(field, cube(), cancelled), Cancelled);
}

}  // namespace
}  // namespace sdm::test
