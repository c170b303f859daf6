// Penetration depth of thin-walled bodies, where nearly all points are as deep as any other.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "bodies/shape/body.h"
#include "bodies/shape/column_box.h"
#include "geometry/vec.h"
#include "inside/solid.h"
#include "scenes/blocks.h"
#include "sites/sites_data.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using scenes::plate_with_hole, scenes::union_of;

// A cube whose sides are grids of n² squares.
Mesh grid_cube(double half_side, int n) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          Vec3 p{};
          p[axis] = side * half_side;
          p[(axis + 1) % 3] = half_side * (2.0 * i / n - 1);
          p[(axis + 2) % 3] = half_side * (2.0 * j / n - 1);
          mesh.positions.push_back(p);
        }
      const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (n + 1) + j); };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (const auto& [a, b, c] : {Triangle{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                                        Triangle{at(i, j), at(i + 1, j + 1), at(i, j + 1)}})
            mesh.triangles.push_back(side > 0 ? Triangle{a, b, c} : Triangle{a, c, b});
    }
  return weld(mesh).mesh;
}

Mesh hollow(const Mesh& outer, const Mesh& cavity) {
  return joined(outer, flipped(cavity));
}

Mesh scaled(Mesh mesh, double by) {
  for (Vec3& p : mesh.positions) p = by * p;
  return mesh;
}

Mesh hollow_ball(double radius, double wall) {
  return hollow(scaled(sphere(3), radius), scaled(sphere(3), radius - wall));
}

// The largest depth of some points of each face of `body` in a solid.
double sampled_depth(const Mesh& body, const Transform& in_solid, const Mesh& solid) {
  std::vector<Vec3> points;
  constexpr int kDivisions = 3;
  for (const auto& [a, b, c] : body.triangles)
    for (int i = 0; i <= kDivisions; ++i)
      for (int j = 0; i + j <= kDivisions; ++j) {
        const double u = static_cast<double>(i) / kDivisions, v = static_cast<double>(j) / kDivisions;
        points.push_back(
            in_solid((1 - u - v) * body.positions[a] + u * body.positions[b] + v * body.positions[c]));
      }
  const Sites sites(solid);
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  double deepest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (closest[i].distance > deepest && inside::contains(internals(sites), {}, points[i]))
      deepest = closest[i].distance;
  return deepest;
}

// The wall of either of two boxes is in the middle of that of the other one.
TEST(WallDepth, OfBoxesInEachOther) {
  const Mesh a = hollow(grid_cube(1, 8), grid_cube(0.98, 8)),
             b = hollow(grid_cube(1.01, 8), grid_cube(0.99, 8));
  for (const double precision : {4e-3, 1e-3, 1e-5}) {
    ProximityQuery query(a, b, {.depth_precision = precision});
    const BoundedLength depth = *query.penetration_depth();
    EXPECT_NEAR(depth.value, 0.01, precision + 1e-5);
    EXPECT_LE(depth.lower, 0.01 + 1e-9);
    EXPECT_GE(depth.upper, 0.01 - 1e-9);
    EXPECT_LE(depth.upper - depth.lower, precision + 2e-5);
  }
}

// A peg that is pressed into one side of its hole is as deep there everywhere.
TEST(WallDepth, OfAPegInATightHole) {
  ProximityQuery query(union_of({{{-0.5, -0.5, -1}, {0.5, 0.5, 1}}}), plate_with_hole(2, 0.51, 1));
  for (const double depth : {1e-7, 5e-4, 1.5e-3, 0.01, 0.19}) {
    query.set_pose(0, Transform::translation({0.01 + depth, 0, 0.8}));
    const BoundedLength found = *query.penetration_depth();
    EXPECT_LE(found.lower, depth + 1e-5);
    EXPECT_GE(found.upper, depth - 1e-5);
    EXPECT_LE(found.upper - found.lower, 1e-3 * std::sqrt(6.0) + 1e-5);
  }
}

// The search ends at its limit, with bounds that hold.
TEST(WallDepth, HasBoundsWhereItsPrecisionIsOutOfReach) {
  ProximityQuery query(union_of({{{-0.5, -0.5, -1}, {0.5, 0.5, 1}}}), plate_with_hole(2, 0.51, 1),
                       {.depth_precision = 1e-12});
  query.set_pose(0, Transform::translation({0.012, 0, 0.8}));
  const BoundedLength found = *query.penetration_depth();
  EXPECT_EQ(found.certainty, Certainty::bounded);
  EXPECT_LE(found.lower, 0.002 + 1e-5);
  EXPECT_GE(found.upper, 0.002 - 1e-5);
  EXPECT_LE(found.upper, 0.0025);
}

// A point in the wall of a hollow ball is at most half a wall deep.
TEST(WallDepth, OfBallsInEachOther) {
  const Mesh a = hollow_ball(1, 0.02), b = hollow_ball(0.99, 0.02);
  ProximityQuery query(a, b);
  for (const Vec3& degrees : {Vec3{0, 0, 0}, Vec3{20, 30, 40}, Vec3{70, 10, 50}}) {
    const Transform pose = Transform::translation({0.001, 0.002, 0}) * Transform::rotation(degrees);
    query.set_pose(1, pose);
    const BoundedLength depth = *query.penetration_depth();
    EXPECT_LE(depth.upper - depth.lower, 1.8e-3 * diagonal(bounds(b)));
    EXPECT_LE(depth.value, 0.01 + 1e-6);
    const double deepest = std::max(sampled_depth(b, pose, a), sampled_depth(a, pose.inverse(), b));
    EXPECT_GT(deepest, 0.009);
    EXPECT_GE(depth.upper, deepest - 1e-6);
    EXPECT_LE(depth.lower, 0.01 + 1e-6);
  }
}

// Intervals hold what is sampled, and intersect whatever the precision, in poses where walls cross.
TEST(WallDepth, HoldsWhereWallsCross) {
  const Mesh ball = hollow_ball(1, 0.02), box = hollow(grid_cube(0.8, 8), grid_cube(0.77, 8));
  for (int i = 0; i < 4; ++i) {
    const Transform pose =
        Transform::translation({0.1 * i, 0.07, 0.03 * i}) * Transform::rotation({20.0 * i, 15.0, 33.0 * i});
    const double deepest = std::max(sampled_depth(box, pose, ball), sampled_depth(ball, pose.inverse(), box));
    double lower = 0, upper = 1;
    for (const double precision : {5e-3, 1e-3, 2e-4}) {
      ProximityQuery query(ball, box, {.depth_precision = precision});
      query.set_pose(1, pose);
      const BoundedLength depth = *query.penetration_depth();
      EXPECT_LE(depth.upper - depth.lower, precision + 2e-5);
      EXPECT_GE(depth.upper, deepest - 1e-6);
      lower = std::max(lower, depth.lower);
      upper = std::min(upper, depth.upper);
      ASSERT_TRUE(depth.witness);
      EXPECT_NEAR(norm((*depth.witness)[1] - (*depth.witness)[0]), depth.value, 1e-6);
    }
    EXPECT_LE(lower, upper);
  }
}

// What is known of the walls of a shape does not change answers: another order of poses, the same bits.
TEST(WallDepth, DoesNotDependOnOtherPoses) {
  const Shape ball(hollow_ball(1, 0.02)), other(hollow_ball(0.99, 0.02));
  const auto depth = [](ProximityQuery& query, double x) {
    query.set_pose(1, Transform::translation({x, 0, 0}));
    return *query.penetration_depth();
  };
  ProximityQuery query(ball, other);
  for (const double x : {0.02, 0.005, 0.3, 0.0}) {
    ProximityQuery anew(hollow_ball(1, 0.02), hollow_ball(0.99, 0.02));
    const BoundedLength first = depth(query, x), second = depth(anew, x);
    EXPECT_EQ(first.value, second.value);
    EXPECT_EQ(first.lower, second.lower);
    EXPECT_EQ(first.upper, second.upper);
  }
}

// A cup, from the middle of its bottom up the outside and back inside.
Mesh cup_of(std::uint32_t around, double wall) {
  const std::array<std::array<double, 2>, 10> profile{{{0.5, 0},
                                                       {1, 0},
                                                       {1, 0.5},
                                                       {1, 1},
                                                       {1 - wall, 1},
                                                       {1 - wall, 0.5},
                                                       {1 - wall, wall},
                                                       {0.5, wall},
                                                       {0, 0},
                                                       {0, wall}}};
  Mesh mesh;
  for (std::size_t row = 0; row < 8; ++row)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * 3.141592653589793 * i / around;
      mesh.positions.push_back(
          {profile[row][0] * std::cos(angle), profile[row][0] * std::sin(angle), profile[row][1]});
    }
  for (const std::size_t middle : {8, 9}) mesh.positions.push_back({0, 0, profile[middle][1]});
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t j = (i + 1) % around;
    for (std::uint32_t row = 0; row < 7; ++row) {
      const std::uint32_t below = row * around, above = below + around;
      mesh.triangles.push_back({below + i, above + j, above + i});
      mesh.triangles.push_back({below + i, below + j, above + j});
    }
    mesh.triangles.push_back({8 * around, j, i});
    mesh.triangles.push_back({8 * around + 1, 7 * around + i, 7 * around + j});
  }
  return mesh;
}

// Bounds hold for the balls that touch the faces at many points, also at ends of walls and where walls meet,
// and are not much larger than those.
TEST(WallThickness, BoundsTheBallsThatTouchEachFace) {
  constexpr double kWall = 0.05;
  const Mesh mesh = cup_of(16, kWall);
  const shape::Body body(mesh, nullptr);
  ASSERT_TRUE(body.solid());
  const sites::SitesData& sites = internals(body.sites());
  std::size_t bounded = 0;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const double bound = body.wall_thickness().of_face(face);
    bounded += bound < 1.5 * 0.5 * kWall;
    const Corners at = corners_of(mesh, face);
    constexpr int kDivisions = 12;
    for (int i = 1; i < kDivisions; ++i)
      for (int j = 1; i + j < kDivisions; ++j) {
        const double u = static_cast<double>(i) / kDivisions, v = static_cast<double>(j) / kDivisions;
        const Vec3 x = (1 - u - v) * at[0] + u * at[1] + v * at[2];
        double radius = 0.5;  // of the largest ball, which shrinks until nothing is in it
        for (int step = 0; step < 60; ++step) {
          const Vec3 centre = x - radius * sites.normals.face[face];
          const Vec3 to = x - closest_points(body.sites(), std::array{centre})[0].point;
          const double along = dot(to, sites.normals.face[face]);
          if (!(along > 1e-12)) break;
          radius = std::min(radius, squared_norm(to) / (2 * along));
        }
        EXPECT_LE(radius, bound + 1e-6) << face;
      }
  }
  EXPECT_GT(bounded, mesh.triangles.size() * 9 / 10);
}

// A bound on the thickness holds for what is below a face, whatever is above it.
TEST(WallDepth, OfABlockUnderSlantedPlatesIsNotThatOfThePlates) {
  const auto plate = [](double up) {
    Mesh mesh = cube();
    for (Vec3& p : mesh.positions) {
      p = {-1.5 + 7.5 * p[0], 5 * p[1], 0.05 * p[2]};
      p[2] += p[0] + 7 + up;
    }
    return mesh;
  };
  const shape::Body body(joined(joined(moved(cube(6), {0, 0, -6}), plate(0)), plate(2)), nullptr);
  ASSERT_TRUE(body.solid());
  for (std::uint32_t face = 0; face < 12; ++face)
    for (int call = 0; call < 2; ++call) EXPECT_GT(body.wall_thickness().of_face(face), 0.3) << face;
}

// Where two bodies of a solid overlap, a wall ends where the last of them does, also if they are inside out.
TEST(WallDepth, DoesNotEndInsideOfSolidsThatAreInsideOut) {
  const Mesh two = joined(moved(grid_cube(5, 10), {5, 5, 5}), moved(grid_cube(3, 3), {5, 5, 0}));
  for (const Mesh& mesh : {two, flipped(two)}) {
    const shape::Body body(mesh, nullptr);
    ASSERT_TRUE(body.solid());
    for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
      const Corners at = corners_of(mesh, face);
      const Vec3 middle = (1.0 / 3) * (at[0] + at[1] + at[2]);
      const bool on_top = middle[2] == 10 && std::abs(middle[0] - 5) < 2 && std::abs(middle[1] - 5) < 2;
      if (on_top) {
        EXPECT_GT(body.wall_thickness().of_face(face), 3) << "points below it are 4 deep";
      }
    }
  }
}

// In the unit frame, eight at a time, nothing is excluded that is in the box around a column, also far from
// the origin.
TEST(WallColumns, AreComparedWithAllFacesInTheirBox) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  std::size_t in_box = 0, found = 0, faces = 0;
  for (const double far : {0.0, 1e6}) {
    Mesh mesh = sphere(3);
    for (Vec3& p : mesh.positions) p = 2.0 * p + far * Vec3{1, -2, 0.5};
    const Sites built(mesh);
    const sites::SitesData& sites = internals(built);
    for (int column = 0; column < 200; ++column) {
      const Vec3 u = normalized(vector()), v = normalized(cross(u, vector())), w = cross(u, v);
      const Vec3 origin = mesh.positions[column] + 0.01 * vector();
      const Vec3 lo{-0.3, -0.1 * std::abs(normal(random)), -0.1},
          hi{0.2, 0.1, 0.1 * std::abs(normal(random))};
      const std::array axes{u, v, w};
      const shape::ColumnBox box(sites.frame, origin, axes, lo, hi);
      std::vector<std::uint8_t> meets(mesh.triangles.size());
      const auto visit = [&](const auto& self, std::uint32_t number) -> void {
        const tree::WideTree::Node& node = sites.wide.nodes[number];
        for (std::uint32_t near = box.meets(node); near != 0; near &= near - 1) {
          const std::uint32_t child = node.child[std::countr_zero(near)];
          if (!tree::WideTree::is_leaf(child)) {
            self(self, child);
            continue;
          }
          const std::uint32_t leaf = tree::WideTree::leaf_number(child);
          const std::uint32_t lanes = box.meets(sites.regions.bounds[leaf]);
          for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i)
            meets[sites.regions.owners[i].face] = lanes >> (i - sites.regions.leaves[leaf]) & 1;
        }
      };
      visit(visit, 0);
      for (std::size_t face = 0; face < meets.size(); ++face) {
        bool overlaps = true;
        for (int a = 0; a < 3; ++a) {
          double least = 1e30, most = -1e30;
          for (const std::uint32_t corner : mesh.triangles[face]) {
            const double at = dot(axes[a], mesh.positions[corner] - origin);
            least = std::min(least, at);
            most = std::max(most, at);
          }
          overlaps &= least <= hi[a] && most >= lo[a];
        }
        EXPECT_LE(overlaps, meets[face] != 0);
        in_box += overlaps;
        found += meets[face];
        ++faces;
      }
    }
  }
  EXPECT_GT(in_box, 100u);
  EXPECT_LT(found, faces / 10);
}

}  // namespace
}  // namespace sdm::test
