// The time of first contact against known results, and against collisions at many times.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

TEST(TimeOfContact, OfCubesThatMeet) {
  const Shape box(cube());
  // A gap of 2, closed by 1 and 3 from both sides.
  const Motion right{.from = Transform::translation({-2, 0, 0}), .to = Transform::translation({-1, 0, 0})};
  const Motion left{.from = Transform::translation({2, 0.3, 0}), .to = Transform::translation({-1, 0.3, 0})};
  const TimeOfContact found = time_of_contact(box, right, box, left, 1e-6);
  EXPECT_TRUE(found.contact);
  EXPECT_LE(found.time, 0.5);
  EXPECT_NEAR(found.time, 0.5, 1e-6);
  EXPECT_GT(found.separation, 0);
  EXPECT_LE(found.separation, 1e-6);
}

// Both ends are free, and all of the plate is passed within 1/1000 of the time.
TEST(TimeOfContact, IsNotMissedThroughAThinPlate) {
  Mesh plate = cube();
  for (Vec3& p : plate.positions) p[0] *= 1e-4;
  const Shape ball(placed(sphere(3), "scale:0.1")), wall(plate);
  const Motion shot{.from = Transform::translation({-5, 0, 0}), .to = Transform::translation({5, 0, 0})};
  const TimeOfContact found = time_of_contact(ball, shot, wall, {}, 1e-5);
  EXPECT_TRUE(found.contact);
  EXPECT_NEAR(found.time, (5 - 0.1 - 1e-4) / 10, 1e-5);
  // Beside the plate there is no contact.
  const Motion beside{.from = Transform::translation({-5, 1.2, 0}),
                      .to = Transform::translation({5, 1.2, 0})};
  const TimeOfContact none = time_of_contact(ball, beside, wall, {}, 1e-5);
  EXPECT_FALSE(none.contact);
  EXPECT_EQ(none.time, 1);
}

// A rod of half-length 3 turns by 180° about Z: its end meets a cube, whose corner is at (√(9 − h²), h) in
// between.
TEST(TimeOfContact, OfARodThatTurns) {
  Mesh rod = cube();
  for (Vec3& p : rod.positions) p = {3 * p[0], 1e-3 * p[1], 0.1 * p[2]};
  const Shape a(rod), b(cube(0.5));
  const Motion turn{.from = {}, .to = Transform::rotation({0, 0, 180})};
  const Motion rest{.from = Transform::translation({0, 2.5, 0}), .to = Transform::translation({0, 2.5, 0})};
  const TimeOfContact found = time_of_contact(a, turn, b, rest, 1e-5);
  EXPECT_TRUE(found.contact);
  // The corner (0.5, 2) of the cube is at this angle.
  EXPECT_NEAR(found.time, std::atan2(2.0, 0.5) / std::acos(-1.0), 1e-3);
}

TEST(TimeOfContact, OfBodiesThatCollideOrRest) {
  const Shape outer(cube()), inner(cube(0.2));
  const Motion away{.from = {}, .to = Transform::translation({9, 0, 0})};
  const TimeOfContact nested = time_of_contact(outer, {}, inner, away, 1e-3);
  EXPECT_TRUE(nested.contact);
  EXPECT_EQ(nested.time, 0);
  const Motion rest{.from = Transform::translation({4, 0, 0}), .to = Transform::translation({4, 0, 0})};
  const TimeOfContact apart = time_of_contact(outer, {}, inner, rest, 1e-3);
  EXPECT_FALSE(apart.contact);
  EXPECT_EQ(apart.time, 1);
  EXPECT_NEAR(apart.separation, 2.8, 1e-12);
}

TEST(TimeOfContact, NoCollisionBefore) {
  const std::array shapes{Shape(load("cow.off", "fit")), Shape(placed(torus(24, 12), "fit"))};
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-1.2, 1.2);
  const auto pose = [&] {
    return Transform::translation({offset(random), offset(random), offset(random)}) *
           Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
  };
  constexpr double kTolerance = 1e-4;
  int contacts = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const std::array motions{Motion{pose(), pose()}, Motion{pose(), pose()}};
    const TimeOfContact found = time_of_contact(shapes[0], motions[0], shapes[1], motions[1], kTolerance);
    ProximityQuery query(shapes[0], shapes[1]);
    const auto set = [&](double time) {
      for (int b = 0; b < 2; ++b) query.set_pose(b, motions[b].at(time, shapes[b]));
    };
    for (int b = 0; b < 2; ++b)
      for (int row = 0; row < 3; ++row)
        for (int k = 0; k < 4; ++k)
          EXPECT_NEAR(motions[b].at(1, shapes[b]).rows[row][k], motions[b].to.rows[row][k], 1e-9);
    for (int step = 0; step < 100; ++step) {
      set(found.time * step / 100);
      ASSERT_TRUE(found.time == 0 || !query.colliding().value);
    }
    set(found.time);
    EXPECT_EQ(found.contact, query.separation().value <= kTolerance || query.colliding().value);
    contacts += found.contact && found.time > 0;
  }
  EXPECT_GT(contacts, 10);
}

TEST(TimeOfContact, RejectsBadInput) {
  const Shape box(cube());
  const Motion grows{.from = {}, .to = Transform::scaling(2)};
  const Motion sheared{.from = {}, .to = {{{{1, 1, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}}};
  EXPECT_THROW((void)time_of_contact(box, grows, box, {}, 1e-3), Error);
  EXPECT_THROW((void)time_of_contact(box, sheared, box, {}, 1e-3), Error);
  for (const double tolerance : {0.0, -1.0, std::nan("")})
    EXPECT_THROW((void)time_of_contact(box, {}, box, {}, tolerance), Error);
}

}  // namespace
}  // namespace sdm::test
