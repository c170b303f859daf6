// The time of first contact against known results, and against collisions at many times.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

Motion straight(const Vec3& from, const Vec3& to) {
  return {.from = Transform::translation(from), .to = Transform::translation(to)};
}

// The surfaces have their closest points at the witness, on the faces named, in the poses of that time.
void expect_witness(const TimeOfContact& found, const std::array<Shape, 2>& shapes,
                    const std::array<Motion, 2>& motions, double rounding = 1e-12) {
  for (int b = 0; b < 2; ++b) {
    const Mesh& mesh = shapes[b].sites().mesh();
    ASSERT_LT(found.faces[b], mesh.triangles.size());
    const Transform pose = motions[b].at(found.time, shapes[b]);
    Corners at;
    for (int i = 0; i < 3; ++i) at[i] = pose(mesh.positions[mesh.triangles[found.faces[b]][i]]);
    const Vec3& p = found.witness[b];
    EXPECT_LE(std::sqrt(closest_points(at, {p, p, p}).squared), rounding);
  }
  const Vec3 apart = found.witness[0] - found.witness[1];
  EXPECT_NEAR(norm(apart), found.separation, rounding);
  if (found.separation > 0) {
    EXPECT_LE(norm(found.separation * found.normal.value() - apart), 1e-9 + rounding);
  }
}

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

// The corner (3, 0.01) of a rod turns to a plane at y = 2: 3 sin t + 0.01 cos t = 2.
TEST(TimeOfContact, OfARodThatOnlyTurns) {
  const Shape rod(box({-3, -0.01, -0.01}, {3, 0.01, 0.01})), wall(box({-9, 2, -9}, {9, 3, 9}));
  const Motion turn{.from = {}, .to = Transform::rotation({0, 0, 135})};
  const double angle = std::asin(2 / std::hypot(3, 0.01)) - std::atan2(0.01, 3);
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const TimeOfContact found = time_of_contact(rod, turn, wall, {}, tolerance);
    EXPECT_TRUE(found.contact);
    EXPECT_EQ(found.certainty, Certainty::exact);
    EXPECT_LE(found.time, angle / (0.75 * std::acos(-1.0)));
    EXPECT_NEAR(found.time, angle / (0.75 * std::acos(-1.0)), tolerance + 1e-14);
    EXPECT_LE(found.separation, tolerance);
    EXPECT_NEAR(found.normal.value()[1], -1, 1e-3);  // of points that are 1e-12 apart, rounded to 1e-16
    expect_witness(found, {rod, wall}, {turn, Motion{}});
  }
  // At a distance beyond its reach, it turns freely.
  for (const double gap : {1e-3, 1e-6, 1e-9}) {
    const double y = std::hypot(3, 0.01) + gap;
    const Shape beyond(box({-9, y, -9}, {9, 4, 9}));
    const TimeOfContact free = time_of_contact(rod, turn, beyond, {}, 0.5 * gap);
    EXPECT_FALSE(free.contact);
    EXPECT_EQ(free.time, 1);
  }
}

// A unit of the time is 1e-13 in space, more than the tolerance.
TEST(TimeOfContact, EndsBelowTheResolutionOfTime) {
  const std::array shapes{Shape(cube(0.5)), Shape(cube(0.5))};
  const std::array motions{Motion{}, straight({1001.3, 0.1, 0.2}, {-1370, 0.13, 0.1})};
  const double meet = 1000.3 / 2371.3;
  for (const double tolerance : {1e-13, 1e-14, 1e-30, 1e-300}) {
    const TimeOfContact found = time_of_contact(shapes[0], motions[0], shapes[1], motions[1], tolerance);
    EXPECT_TRUE(found.contact);
    EXPECT_EQ(found.certainty, Certainty::bounded);
    EXPECT_LT(found.time, meet);
    EXPECT_NEAR(found.time, meet, 1e-14);
    EXPECT_GT(found.separation, tolerance);
    EXPECT_LT(found.separation, 1e-10);
    EXPECT_NEAR(found.normal.value()[0], -1, 1e-3);
    expect_witness(found, shapes, motions);
  }
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    const TimeOfContact found = time_of_contact(shapes[0], motions[0], shapes[1], motions[1], tolerance);
    EXPECT_TRUE(found.contact);
    EXPECT_EQ(found.certainty, Certainty::exact);
    EXPECT_LT(found.time, meet);
    EXPECT_NEAR(found.time, meet, tolerance / 2371);
    EXPECT_LE(found.separation, tolerance);
  }
  // Beside each other there is no contact, whatever the speed.
  for (const double far : {1e3, 1e6, 1e12, 1e30}) {
    const TimeOfContact past =
        time_of_contact(shapes[0], {}, shapes[1], straight({far, 1.1, 0.2}, {-far, 1.1, 0.1}), 1e-13);
    EXPECT_FALSE(past.contact);
    EXPECT_EQ(past.time, 1);
    EXPECT_EQ(past.certainty, Certainty::exact);
  }
}

TEST(TimeOfContact, OfPosesFarAway) {
  const Shape box(cube(0.5));
  const TimeOfContact found = time_of_contact(box, {}, box, straight({1e30, 0.1, 0}, {-2e30, 0, 0}), 1e-6);
  EXPECT_TRUE(found.contact);
  EXPECT_EQ(found.certainty, Certainty::bounded);
  EXPECT_LT(found.time, 1.0 / 3);
  EXPECT_NEAR(found.time, 1.0 / 3, 1e-14);
  const TimeOfContact rest = time_of_contact(box, {}, box, straight({1e30, 0, 0}, {1e30, 0, 0}), 1e-6);
  EXPECT_FALSE(rest.contact);
  EXPECT_EQ(rest.time, 1);
  EXPECT_NEAR(rest.separation, 1e30, 1e16);
  // Both are far away: 5 apart across, where coordinates are small, and by two units of those that are not.
  const Transform turned = Transform::rotation({0, 0, 40});
  const Motion there = straight({1e30, 0, 0}, {1e30, 0, 0});
  const auto beside = [&](const Vec3& at) {
    return time_of_contact(box, there, box, {Transform::translation(at), Transform::translation(at) * turned},
                           1e-6);
  };
  EXPECT_FALSE(beside({1e30, 5, 0}).contact);
  const TimeOfContact unknown = beside({1e30 + 3e14, 0, 0});
  EXPECT_TRUE(unknown.contact);
  EXPECT_EQ(unknown.certainty, Certainty::bounded);
  EXPECT_EQ(unknown.time, 0);
  EXPECT_GT(unknown.separation, 1e14);
  // Spinning far away.
  const Motion spin{.from = Transform::translation({0, 1e30, 0}),
                    .to = Transform::translation({0, 1e30, 0}) * Transform::rotation({0, 0, 180})};
  EXPECT_FALSE(time_of_contact(box, {}, box, spin, 1e-6).contact);
}

// Bodies slide along each other at 1.01 to 3 times the tolerance: as boxes, turned in space, turned in the
// frames of their meshes, and divided into small faces.
TEST(TimeOfContact, OfBodiesThatSlideInParallel) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const double tolerance : {1e-5, 1e-9})
    for (const double gaps : {1.01, 1.5, 3.0}) {
      SCOPED_TRACE(testing::Message() << gaps << " times " << tolerance);
      const double gap = gaps * tolerance;
      const Motion slide = straight({-7, 0.3, 0}, {7, -0.4, 0});
      const auto expect_free = [&](const Mesh& m1, const Motion& p1, const Mesh& m2, const Motion& p2) {
        const TimeOfContact found = time_of_contact(Shape(m1), p1, Shape(m2), p2, tolerance);
        EXPECT_FALSE(found.contact);
        EXPECT_EQ(found.time, 1);
        EXPECT_EQ(found.certainty, Certainty::exact);
      };
      const Mesh above = box({-1, -1, gap}, {1, 1, 1}), below = box({-2, -2, -1}, {2, 2, 0});
      expect_free(above, slide, below, {});
      const Transform turned = Transform::quaternion({normal(random), normal(random), normal(random), 1});
      Mesh above2 = above, below2 = below;
      transform(above2, turned);
      transform(below2, turned);
      expect_free(above, {turned * slide.from, turned * slide.to}, below, {turned, turned});
      expect_free(above2, straight(turned({-7, 0.3, 0}), turned({7, -0.4, 0})), below2, {});
      // It turns about the normal of the gap as it slides.
      expect_free(above, {slide.from, slide.to * Transform::rotation({0, 0, 120})}, below, {});
      Mesh grid1 = height_field(12), grid2 = height_field(20);
      for (Vec3& p : grid1.positions) p[2] = gap;
      for (Vec3& p : grid2.positions) p[2] = 0;
      transform(grid1, turned);
      transform(grid2, turned);
      expect_free(grid1, straight(turned({-2, 0.3, 0}), turned({2, -0.4, 0})), grid2, {});
    }
}

// The closest faces slide along each other, while an arm of the same body approaches from farther away.
TEST(TimeOfContact, IsThatOfTheArmThatArrives) {
  const Mesh near = box({-6, -1, 0.01}, {6, 1, 0.5}), arm = box({5, -1, -3}, {6, 1, 0.01});
  const Shape fork(joined(near, arm)), table(box({-2, -2, -1}, {2, 2, 0}));
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const std::array motions{straight({0, 0, 0}, {-8, 0, 0}), Motion{}};
    const TimeOfContact found = time_of_contact(fork, motions[0], table, motions[1], tolerance);
    EXPECT_TRUE(found.contact);
    EXPECT_LE(found.time, 3.0 / 8);
    EXPECT_NEAR(found.time, 3.0 / 8, tolerance);
    EXPECT_NEAR(found.normal.value()[0], 1, 1e-9);
    expect_witness(found, {fork, table}, motions);
  }
}

// The lower edge of a bar, across the upper edge of another: they pass each other above the tolerance, and
// meet just below.
TEST(TimeOfContact, OfEdgesThatGraze) {
  Mesh bar = box({-3, -0.5, -0.5}, {3, 0.5, 0.5});
  transform(bar, Transform::rotation({45, 0, 0}));  // its edges are √½ above and below
  Mesh across = bar;
  transform(across, Transform::rotation({0, 0, 77}));
  const Shape lower(bar), upper(across);
  const double height = 2 * std::sqrt(0.5);
  for (const double tolerance : {1e-4, 1e-8}) {
    const auto at = [&](double gap) {
      return time_of_contact(lower, {}, upper, straight({1, 5, height + gap}, {0.5, -4, height + gap}),
                             tolerance);
    };
    for (const double gap : {1.1, 1.5, 10.0}) EXPECT_FALSE(at(gap * tolerance).contact);
    for (const double gap : {0.4, 0.0, -1.0, -1000.0}) {
      const TimeOfContact found = at(gap * tolerance);
      EXPECT_TRUE(found.contact);
      EXPECT_LE(found.separation, tolerance);
      EXPECT_EQ(found.certainty, Certainty::exact);
    }
  }
}

// A wheel of 24 corners rolls and spins above a plane, at distances of its corners from it of some
// tolerances.
TEST(TimeOfContact, OfAWheelThatGrazes) {
  Mesh wheel = box({-1, -1, -0.2}, {1, 1, 0.2});
  for (int turn = 1; turn < 6; ++turn) {
    Mesh next = box({-1, -1, -0.2}, {1, 1, 0.2});
    transform(next, Transform::rotation({0, 0, 15.0 * turn}));
    wheel = joined(wheel, next);
  }
  const Shape o1(wheel), o2(box({-9, -3, -9}, {9, 0, 9}));
  for (const double tolerance : {1e-4, 1e-7})
    for (const double gap : {1.2, 3.0, 0.3}) {
      const double y = std::sqrt(2.0) + gap * tolerance;
      const Motion rolls{.from = Transform::translation({-4, y, 0}) * Transform::rotation({0, 0, 5}),
                         .to = Transform::translation({3, y, 0}) * Transform::rotation({0, 0, 175})};
      const TimeOfContact found = time_of_contact(o1, rolls, o2, {}, tolerance);
      EXPECT_EQ(found.contact, gap < 1);
      EXPECT_GT(found.time, 0);
      EXPECT_EQ(found.certainty, Certainty::exact);
    }
}

// A ball turns in an open socket, a bolt screws itself through a sleeve: all of their faces are close to
// others at all times.
TEST(TimeOfContact, OfBodiesThatTurnInsideOthers) {
  const Mesh ball = sphere(3);
  Mesh socket = ball;
  std::erase_if(socket.triangles, [&](const Triangle& t) { return socket.positions[t[0]][2] > 0.9; });
  for (const double gap : {0.01, 1e-6}) {
    // The middles of the socket's faces are nearer than its corners, by less than 0.004.
    Mesh wide = socket;
    transform(wide, Transform::scaling(1.005 + gap));
    const TimeOfContact free =
        time_of_contact(Shape(ball), {{}, Transform::rotation({40, -20, 130})}, Shape(wide), {}, 0.1 * gap);
    EXPECT_FALSE(free.contact);
    EXPECT_EQ(free.certainty, Certainty::exact);
  }
  Mesh sleeve = band(96, false), bolt = sleeve;
  const double inner = [&] {  // of the polygon's middles
    double least = 1e9;
    for (const Triangle& t : sleeve.triangles)
      for (int i = 0; i < 3; ++i) {
        const Vec3 middle = 0.5 * (sleeve.positions[t[i]] + sleeve.positions[t[(i + 1) % 3]]);
        least = std::min(least, std::hypot(middle[0], middle[1]));
      }
    return least;
  }();
  double outer = 0;
  for (const Vec3& p : bolt.positions) outer = std::max(outer, std::hypot(p[0], p[1]));
  for (const double gap : {1e-3, 1e-7}) {
    Mesh thin = bolt;
    for (Vec3& p : thin.positions)
      for (int k = 0; k < 2; ++k) p[k] *= inner * (1 - gap) / outer;
    const Motion screws{.from = Transform::translation({0, 0, -5}),
                        .to = Transform::translation({0, 0, 5}) * Transform::rotation({0, 0, 170})};
    EXPECT_FALSE(time_of_contact(Shape(thin), screws, Shape(sleeve), {}, 0.1 * gap).contact);
    const Motion tilts{.from = screws.from, .to = screws.to * Transform::rotation({3, 0, 0})};
    const TimeOfContact found = time_of_contact(Shape(thin), tilts, Shape(sleeve), {}, 0.1 * gap);
    EXPECT_TRUE(found.contact);
    EXPECT_LE(found.separation, 0.1 * gap);
  }
}

TEST(TimeOfContact, OfTrianglesThatFlyThroughEachOther) {
  const Shape triangle(single_triangle());
  Mesh crossing = single_triangle();
  const Vec3 middle = centre(bounds(crossing));
  transform(crossing, Transform::translation(middle) * Transform::rotation({90, 0, 0}) *
                          Transform::translation(-middle));
  const Shape other(crossing);
  for (const double far : {1.0, 1e3, 1e6}) {
    const Vec3 way = far * Vec3{0.3, 0.1, 2};
    EXPECT_TRUE(time_of_contact(triangle, {}, other, straight(way, -way), 1e-6 * far).contact);
    EXPECT_TRUE(time_of_contact(triangle, straight(way, -way), triangle, {}, 1e-6 * far).contact);
  }
}

TEST(TimeOfContact, OfBodiesThatMoveTogether) {
  const Shape box(cube());
  const TimeOfContact together =
      time_of_contact(box, straight({0, 0, 0}, {50, 30, 1}), box, straight({2.1, 0, 0}, {52.1, 30, 1}), 1e-3);
  EXPECT_FALSE(together.contact);
  EXPECT_EQ(together.time, 1);
  EXPECT_NEAR(together.separation, 0.1, 1e-12);
  EXPECT_EQ(together.certainty, Certainty::exact);
}

TEST(TimeOfContact, StartsWithTheDirectionThatSeparates) {
  const Motion leaves = straight({0, 0, 0}, {5, 0, 0});
  // Inside a body, near its right side.
  const Shape outer(cube()), inner(cube(0.2));
  const Motion right = straight({0.7, 0, 0}, {5, 0, 0});
  const std::array contained{time_of_contact(inner, right, outer, {}, 1e-3),
                             time_of_contact(outer, {}, inner, right, 1e-3)};
  for (int b = 0; b < 2; ++b) {
    EXPECT_TRUE(contained[b].contact);
    EXPECT_EQ(contained[b].time, 0);
    EXPECT_EQ(contained[b].certainty, Certainty::exact);
    EXPECT_NEAR(contained[b].separation, 0.1, 1e-12);
    EXPECT_NEAR(contained[b].normal.value()[0], b == 0 ? 1 : -1, 1e-12);
  }
  const TimeOfContact across =
      time_of_contact(outer, leaves, Shape(cube(1.1)), straight({1, 1, 1}, {9, 9, 9}), 1e-3);
  EXPECT_TRUE(across.contact);
  EXPECT_EQ(across.time, 0);
  EXPECT_EQ(across.separation, 0);
  EXPECT_EQ(across.normal, std::nullopt);
  const TimeOfContact touching =
      time_of_contact(outer, {}, outer, straight({2.0005, 0.3, 0}, {9, 9, 9}), 1e-3);
  EXPECT_TRUE(touching.contact);
  EXPECT_EQ(touching.time, 0);
  EXPECT_NEAR(touching.normal.value()[0], -1, 1e-9);
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
      ASSERT_TRUE(found.time == 0 || (!query.colliding() && query.separation().value > 0.5 * kTolerance));
    }
    set(found.time);
    EXPECT_EQ(found.contact, query.separation().value <= kTolerance || query.colliding());
    EXPECT_EQ(found.separation, query.separation().value);
    EXPECT_EQ(found.certainty, Certainty::exact);
    expect_witness(found, shapes, motions);
    contacts += found.contact && found.time > 0;
  }
  EXPECT_GT(contacts, 10);
}

// Of any triangles, by their distances at many times: none is within the tolerance before the contact, and if
// there is none, at no time.
TEST(TimeOfContact, OfSoups) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-8, -2);
  int contacts = 0, none = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const std::array shapes{Shape(i % 2 == 0 ? soup(12, random) : degenerate_soup(12, i)),
                            Shape(soup(8, random))};
    const auto pose = [&](double size) {
      return Transform::translation({size * normal(random), size * normal(random), size * normal(random)}) *
             Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
    };
    const std::array motions{Motion{pose(1), pose(1)}, Motion{pose(3), pose(2)}};
    const double tolerance = std::pow(10, exponent(random));
    const TimeOfContact found = time_of_contact(shapes[0], motions[0], shapes[1], motions[1], tolerance);
    ProximityQuery query(shapes[0], shapes[1]);
    const auto separation = [&](double time) {
      for (int b = 0; b < 2; ++b) query.set_pose(b, motions[b].at(time, shapes[b]));
      return query.separation().value;
    };
    EXPECT_EQ(found.certainty, Certainty::exact);
    EXPECT_EQ(found.contact, separation(found.time) <= tolerance);
    EXPECT_EQ(found.separation, query.separation().value);
    if (!found.contact) {
      EXPECT_EQ(found.time, 1);
    }
    expect_witness(found, shapes, motions, 1e-9);
    for (int step = 0; step < 400 && found.time > 0; ++step)
      ASSERT_GT(separation(found.time * step / 400), 0.5 * tolerance);
    contacts += found.contact && found.time > 0;
    none += !found.contact;
  }
  EXPECT_GT(contacts, 30);
  EXPECT_GT(none, 30);
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
