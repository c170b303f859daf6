// Bodies with integer corners in integer poses: they touch in faces, edges and vertices, lie in each other
// and fit holes without room. Every call answers, and the answers agree.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "scenes/blocks.h"

namespace sdm::test {
namespace {

// All with coordinates from 0 to 8.
std::vector<Shape> integer_shapes() {
  using scenes::union_of;
  std::vector<Shape> shapes;
  shapes.emplace_back(union_of({{{0, 0, 0}, {1, 1, 1}}}));
  shapes.emplace_back(union_of({{{0, 0, 0}, {2, 2, 4}}}));  // fits the holes
  shapes.emplace_back(union_of({{{0, 0, 0}, {6, 6, 6}}}));
  shapes.emplace_back(union_of({{{0, 0, 0}, {1, 1, 8}}}));
  shapes.emplace_back(union_of({{{0, 0, 0}, {4, 4, 1}}, {{0, 0, 1}, {1, 4, 4}}}));  // an angle
  shapes.emplace_back(union_of({{{0, 0, 0}, {6, 2, 6}},                             // a plate with a hole
                                {{0, 4, 0}, {6, 6, 6}},
                                {{0, 2, 0}, {2, 4, 6}},
                                {{4, 2, 0}, {6, 4, 6}}}));
  shapes.emplace_back(union_of({{{0, 0, 0}, {6, 6, 2}},  // a hole that is closed below
                                {{0, 0, 2}, {6, 2, 4}},
                                {{0, 4, 2}, {6, 6, 4}},
                                {{0, 2, 2}, {2, 4, 4}},
                                {{4, 2, 2}, {6, 4, 4}}}));
  shapes.emplace_back(union_of({{{0, 0, 0}, {8, 2, 1}}, {{0, 0, 1}, {1, 2, 4}}, {{3, 0, 1}, {4, 2, 4}}}));
  shapes.emplace_back(Mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},  // a tetrahedron
                           {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                           {}});
  shapes.emplace_back(
      Mesh{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}});  // a surface
  return shapes;
}

Transform integer_turn(std::mt19937& random) {
  std::uniform_int_distribution<int> turn(0, 3);
  return Transform::rotation({90.0 * turn(random), 90.0 * turn(random), 90.0 * turn(random)});
}

Box box_of(const Shape& shape, const Transform& pose) {
  Box box;
  for (const Vec3& p : shape.sites().mesh().positions) extend(box, pose(p));
  return box;
}

struct IntegerPair {
  std::size_t a = 0, b = 0;
  std::array<Transform, 2> poses;
};

// Shapes whose boxes touch at least; of a fifth of all, the bar is in a hole or over it.
IntegerPair integer_pair(const std::vector<Shape>& shapes, int i) {
  std::mt19937 random(static_cast<unsigned>(i));
  std::uniform_int_distribution<std::size_t> any(0, shapes.size() - 1);
  IntegerPair pair;
  const Transform common =
      Transform::translation(i % 4 == 0 ? Vec3{1000, 1000, 1000} : Vec3{}) * integer_turn(random);
  if (i % 5 == 0) {
    std::uniform_int_distribution<int> height(-6, 7);
    pair = {1, 5 + static_cast<std::size_t>(i / 5 % 2), {}};
    pair.poses = {common * Transform::translation({2, 2, 1.0 * height(random)}), common};
    return pair;
  }
  pair = {any(random), any(random), {integer_turn(random), integer_turn(random)}};
  const Box a = box_of(shapes[pair.a], pair.poses[0]), b = box_of(shapes[pair.b], pair.poses[1]);
  Vec3 shift;
  for (int k = 0; k < 3; ++k)
    shift[k] =
        std::uniform_int_distribution<int>(static_cast<int>(std::lround(b.lower[k] - a.upper[k])),
                                           static_cast<int>(std::lround(b.upper[k] - a.lower[k])))(random);
  pair.poses[0] = common * Transform::translation(shift) * pair.poses[0];
  pair.poses[1] = common * pair.poses[1];
  return pair;
}

void check_answers(const Shape& a, const Shape& b, const std::array<Transform, 2>& poses, bool margin) {
  const ProximityOptions options{.contact_margin = margin ? 0.5 : 0.0};
  ProximityQuery query(a, b, options);
  for (int body = 0; body < 2; ++body) query.set_pose(body, poses[body]);
  const BoundedLength separation = query.separation();
  const bool colliding = query.colliding();
  const std::optional<BoundedLength> depth = query.penetration_depth();
  const SeparatingTranslation out = query.separating_translation();
  constexpr double kExact = 1e-4;  // of sizes up to 15, with an offset of 1000
  EXPECT_TRUE(std::isfinite(separation.value));
  EXPECT_TRUE(separation.value == 0 || separation.value > 0.1) << "of integers";
  if (separation.value == 0) {
    EXPECT_TRUE(colliding);
  }
  EXPECT_EQ(out.upper > 0, colliding);
  EXPECT_LE(out.lower, out.upper);
  if (depth) {
    EXPECT_LE(depth->lower, depth->upper);
    EXPECT_EQ(depth->upper > 0, colliding);
    EXPECT_LE(depth->lower, out.upper + kExact);
  }
  for (const Contact& c : query.contacts()) {
    EXPECT_NEAR(norm(c.normal), 1, 1e-9);
    EXPECT_LE(c.depth, depth ? depth->upper + kExact : 0.0);
  }
  std::size_t count = 0;
  for (const Contact& c : query.separating_contacts()) {
    EXPECT_NEAR(norm(c.normal), 1, 1e-9);
    EXPECT_LE(c.depth, dot(c.normal, out.translation) + kExact);
    ++count;
  }
  if (colliding) {
    EXPECT_GT(count, 0u);
  }
  MultiBodyQuery world({a, b}, options);
  world.set_poses(poses);
  ASSERT_EQ(world.separating_translations().size(), colliding ? 1u : 0u);
  if (colliding) {
    EXPECT_EQ(world.separating_translations()[0].separating_translation.upper, out.upper);
  }
  std::size_t in_world = 0;
  for (const PairContacts& pair : world.separating_contacts()) in_world += pair.contacts.size();
  EXPECT_EQ(in_world, count);
  query.set_pose(0, Transform::translation(out.translation) * query.pose(0));
  EXPECT_FALSE(query.colliding());
}

TEST(IntegerPoses, HaveAllAnswers) {
  const auto asked = [](const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
  };
  const int first = asked("SDM_FIRST_INTEGER", 0), count = asked("SDM_INTEGERS", 300);
  ASSERT_GT(count, 0);
  const std::vector<Shape> shapes = integer_shapes();
  int touching = 0;
  for (int i = first; i < first + count; ++i) {
    SCOPED_TRACE("pose " + std::to_string(i));
    const auto& [first_shape, second_shape, poses] = integer_pair(shapes, i);
    const Shape &a = shapes[first_shape], &b = shapes[second_shape];
    check_answers(a, b, poses, i % 2 == 1);
    if (HasFailure()) return;
    ProximityQuery pair(a, b);
    for (int body = 0; body < 2; ++body) pair.set_pose(body, poses[body]);
    touching += pair.separation().value == 0;
  }
  EXPECT_GT(touching, count / 2);
}

// A face of the cube has its centre on the slanted face of the tetrahedron, to the last digit inside or
// outside. Its deepest points are on the edge of the cube from (1, 2, 0) to (1, 2, 1), as far from z = 0 as
// from there.
TEST(IntegerPoses, DepthOfAFaceWhoseCentreIsOnTheSurface) {
  const std::vector<Shape> shapes = integer_shapes();
  const Shape &cube = shapes[0], &tetrahedron = shapes[8];
  const auto check = [&](const std::array<Transform, 2>& poses) {
    ProximityQuery query(cube, tetrahedron);
    for (int body = 0; body < 2; ++body) query.set_pose(body, poses[body]);
    const double truth = 1 / (1 + std::sqrt(3.0));
    const BoundedLength& depth = *query.penetration_depth();
    EXPECT_LE(depth.lower, truth);
    EXPECT_GE(depth.upper, truth);
    EXPECT_NEAR(depth.value, truth, 2e-3);
  };
  for (const int seed : {8191, 10201}) {
    const auto& [a, b, poses] = integer_pair(shapes, seed);
    ASSERT_EQ(a, 0u);
    ASSERT_EQ(b, 8u);
    check(poses);
  }
  for (int turn = 0; turn < 64; ++turn) {
    const Transform rotation =
        Transform::rotation({90.0 * (turn % 4), 90.0 * (turn / 4 % 4), 90.0 * (turn / 16)});
    const Box turned = box_of(cube, rotation);
    check({Transform::translation({1 - std::round(turned.lower[0]), 2 - std::round(turned.lower[1]),
                                   -std::round(turned.lower[2])}) *
               rotation,
           Transform{}});
  }
}

}  // namespace
}  // namespace sdm::test
