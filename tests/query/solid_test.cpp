// Meshes as solids: inside, outside, and beside each other.
#include "inside/solid.h"

#include <gtest/gtest.h>

#include "engine/oracle.h"
#include "engine/support.h"
#include "poses.h"

namespace sdm {
namespace {

bool collide(const Mesh& m1, const Mesh& m2, const Affine& pose = {}) {
  const Sites o1(m1), o2(m2);
  exact::PairWorkspace workspace;
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

TEST(Solid, Nested) {
  const Mesh ball = test::sphere(2), small = scaled(ball, 0.3);
  EXPECT_TRUE(collide(ball, small));
  EXPECT_TRUE(collide(test::turned(ball), small)) << "the file's orientation does not matter";
  EXPECT_FALSE(collide(ball, small, {.offset = {1.5, 0, 0}}));
  EXPECT_TRUE(collide(ball, triangle_at({0.2, 0.1, 0})));
  EXPECT_FALSE(collide(ball, triangle_at({0.9, 0.9, 0.9}))) << "in the box, outside the ball";
}

TEST(Solid, OpenMeshesHaveNoInside) {
  Mesh open = test::sphere(2);
  open.triangles.erase(open.triangles.begin());
  EXPECT_FALSE(collide(open, scaled(test::sphere(2), 0.3)));
  EXPECT_FALSE(collide(open, scaled(open, 0.3)));
  EXPECT_TRUE(collide(test::sphere(2), scaled(open, 0.3)));
}

TEST(Solid, EveryComponentCounts) {
  const Mesh ball = test::sphere(2), outside = scaled(ball, 0.2, {2, 0, 0}), inside = scaled(ball, 0.2);
  EXPECT_FALSE(collide(ball, test::joined(outside, scaled(outside, 1, {1, 0, 0}))));
  EXPECT_TRUE(collide(ball, test::joined(outside, inside)));
  EXPECT_TRUE(collide(ball, test::joined(inside, outside)));
}

TEST(Solid, HollowShells) {
  const Mesh ball = test::sphere(2), shell = test::joined(ball, scaled(ball, 0.5));
  EXPECT_FALSE(collide(shell, scaled(ball, 0.2))) << "within the hollow";
  EXPECT_TRUE(collide(shell, triangle_at({0.7, 0, 0}))) << "within the wall";
  const Mesh cored = test::joined(shell, scaled(ball, 0.3));
  EXPECT_TRUE(collide(cored, scaled(ball, 0.2)));
  EXPECT_FALSE(collide(cored, triangle_at({0.4, 0, 0})));
  const Mesh overlapping = test::joined(ball, scaled(ball, 1, {0.5, 0, 0}));
  EXPECT_TRUE(collide(overlapping, triangle_at({0.25, 0, 0}))) << "within both: solid";
}

TEST(Solid, TouchingIsColliding) {
  EXPECT_TRUE(collide(test::cube(), test::cube(), {.offset = {2, 0.5, 0.5}}));
  EXPECT_FALSE(collide(test::cube(), test::cube(), {.offset = {std::nextafter(2.0, 3.0), 0.5, 0.5}}));
}

TEST(Solid, WindingIsNotToldByEdges) {
  const Sites cube(test::cube()), mirrored(test::turned(test::cube()));
  const Vec3 middle{0, 0, 0};
  for (const Vec3& q : {Vec3{3, 3, 3}, Vec3{3, 0, 3}, Vec3{3, 3, 1}, Vec3{0, 0, 4}})
    EXPECT_FALSE(winding(internals(cube), {}, middle, q)) << "corner, edge, edge, diagonal of a side";
  for (const Vec3& q : {Vec3{3, 1, 2}, Vec3{-1, 0.5, -4}, Vec3{0.5, -4, 0}}) {
    const std::optional<int> turns = winding(internals(cube), {}, middle, q);
    ASSERT_TRUE(turns);
    EXPECT_EQ(std::abs(*turns), 1);
    EXPECT_EQ(winding(internals(mirrored), {}, middle, q), turns);
    EXPECT_EQ(winding(internals(cube), {}, Vec3{-1.5, 0.9, -3}, q), 0) << "outside";
  }
}

TEST(Solid, ContainsOnTheGrid) {
  Mesh mesh = test::cube();
  for (int axis = 0; axis < 3; ++axis)  // shear: slanted sides
    for (Vec3& p : mesh.positions) p[axis] += 0.25 * p[(axis + 1) % 3];
  const Sites cube(test::cube(4)), slanted(mesh);
  const Affine in_place;
  const oracle::CgalInside expected(mesh);
  for (int x = -7; x <= 7; ++x)
    for (int y = -7; y <= 7; ++y)
      for (int z = -7; z <= 7; ++z) {
        const Vec3 p{double(x), double(y), double(z)};
        const double most = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
        if (most != 4) {
          EXPECT_EQ(contains(internals(cube), in_place, p), most < 4);
        }
        const Vec3 q = 0.26 * p + Vec3{0.01, 0.02, 0.03};
        EXPECT_EQ(contains(internals(slanted), in_place, q), expected(q));
      }
}

TEST(Solid, ContainsAgreesWithCgal) {
  std::mt19937 random(11);
  const Mesh mesh = test::load("elephant.off", "fit");
  const Sites sites(mesh);
  ASSERT_TRUE(internals(sites).is_solid());
  const oracle::CgalInside expected(mesh);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = test::random_point(bounds(mesh), random);
    Affine pose = bench::random_rotation(random);
    pose.offset = {1, 2, 3};
    if (i % 2 == 1) pose.rows[1] = -2.0 * pose.rows[1];  // mirrored
    ASSERT_EQ(contains(internals(sites), {}, p), expected(p));
    ASSERT_EQ(contains(internals(sites), pose, pose(p)), expected(p));
    inside += expected(p);
  }
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace sdm
