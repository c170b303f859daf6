// Collision of solids: nested, hollow, touching, apart.
#include "bodies/pairs/collision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace sdm::pairs {
namespace {

bool collide(const Mesh& m1, const Mesh& m2, const Affine& pose = {}) {
  const Sites o1(m1), o2(m2);
  PairWorkspace workspace;
  const bool result = colliding({internals(o1), internals(o2), pose}, workspace);
  EXPECT_EQ(colliding({internals(o2), internals(o1), inverse(pose)}, workspace), result) << "swapped";
  return result;
}

Mesh scaled(Mesh mesh, double factor, const Vec3& to = {}) {
  for (Vec3& p : mesh.positions) p = factor * p + to;
  return mesh;
}

Mesh triangle_at(const Vec3& at, double size = 0.01) {
  return {.positions = {at, at + Vec3{size, 0, 0}, at + Vec3{0, size, 0}},
          .triangles = {{0, 1, 2}},
          .corner_uvs = {}};
}

TEST(SolidCollision, Nested) {
  const Mesh ball = test::sphere(2), small = scaled(ball, 0.3);
  EXPECT_TRUE(collide(ball, small));
  EXPECT_TRUE(collide(test::flipped(ball), small)) << "the file's orientation does not matter";
  EXPECT_FALSE(collide(ball, small, {.offset = {1.5, 0, 0}}));
  EXPECT_TRUE(collide(ball, triangle_at({0.2, 0.1, 0})));
  EXPECT_FALSE(collide(ball, triangle_at({0.9, 0.9, 0.9}))) << "in the box, outside the ball";
}

TEST(SolidCollision, OpenMeshesHaveNoInside) {
  Mesh open = test::sphere(2);
  open.triangles.erase(open.triangles.begin());
  EXPECT_FALSE(collide(open, scaled(test::sphere(2), 0.3)));
  EXPECT_FALSE(collide(open, scaled(open, 0.3)));
  EXPECT_TRUE(collide(test::sphere(2), scaled(open, 0.3)));
}

TEST(SolidCollision, TestsEveryComponent) {
  const Mesh ball = test::sphere(2), outside = scaled(ball, 0.2, {2, 0, 0}), inside = scaled(ball, 0.2);
  EXPECT_FALSE(collide(ball, test::joined(outside, scaled(outside, 1, {1, 0, 0}))));
  EXPECT_TRUE(collide(ball, test::joined(outside, inside)));
  EXPECT_TRUE(collide(ball, test::joined(inside, outside)));
}

TEST(SolidCollision, HollowShells) {
  const Mesh ball = test::sphere(2), shell = test::joined(ball, scaled(ball, 0.5));
  EXPECT_FALSE(collide(shell, scaled(ball, 0.2))) << "within the hollow";
  EXPECT_TRUE(collide(shell, triangle_at({0.7, 0, 0}))) << "within the wall";
  const Mesh cored = test::joined(shell, scaled(ball, 0.3));
  EXPECT_TRUE(collide(cored, scaled(ball, 0.2)));
  EXPECT_FALSE(collide(cored, triangle_at({0.4, 0, 0})));
  const Mesh overlapping = test::joined(ball, scaled(ball, 1, {0.5, 0, 0}));
  EXPECT_TRUE(collide(overlapping, triangle_at({0.25, 0, 0}))) << "within both: solid";
}

TEST(SolidCollision, TouchingCounts) {
  EXPECT_TRUE(collide(test::cube(), test::cube(), {.offset = {2, 0.5, 0.5}}));
  EXPECT_FALSE(collide(test::cube(), test::cube(), {.offset = {std::nextafter(2.0, 3.0), 0.5, 0.5}}));
}

}  // namespace
}  // namespace sdm::pairs
