// Points inside solids, by the winding number.
#include "inside/solid.h"
#include "geometry/vec.h"

#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/triangle_pair.h"
#include "inside/face_pairs.h"
#include "inside/near_faces.h"
#include "poses.h"
#include "scenes/blocks.h"
#include "sites/sites_data.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm::inside {
namespace {

TEST(Solid, WindingIsUndecidedThroughEdges) {
  const Sites cube(test::cube()), mirrored(test::flipped(test::cube()));
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

// A double pyramid whose base goes twice around, so that faces of both apices intersect.
Mesh turned_twice() {
  Mesh mesh;
  constexpr std::uint32_t kSides = 14;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double turn = 4 * std::numbers::pi * i / kSides, radius = 1 + 0.5 * std::cos(turn / 2);
    mesh.positions.push_back({radius * std::cos(turn), radius * std::sin(turn), 0.1 * std::sin(turn / 2)});
  }
  mesh.positions.push_back({0, 0, 0.7});
  mesh.positions.push_back({0, 0, -0.7});
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t next = (i + 1) % kSides;
    mesh.triangles.push_back({i, next, kSides});
    mesh.triangles.push_back({next, i, kSides + 1});
  }
  return mesh;
}

// Closed: embedded, with overlaps, with needles, folds and fans that overlap.
std::vector<Mesh> closed_meshes() {
  Mesh spike = test::sphere(3);
  spike.positions[0] = 40.0 * spike.positions[0];
  Mesh pressed = test::sphere(3);
  for (Vec3& p : pressed.positions) p[2] *= 1e-5;
  return {test::load("elephant.off", "fit"),
          test::load("cow.off", "fit"),
          test::joined(test::sphere(3), test::moved(test::sphere(3), {0.6, 0.1, 0.2})),
          test::cube(),
          spike,
          pressed,
          turned_twice()};
}

TEST(Solid, CrossingsOfFacesInLanesAreThoseOfTheTree) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1.3, 1.3);
  for (const Mesh& mesh : closed_meshes()) {
    const Sites sites(mesh);
    const auto vertex = [&] { return mesh.positions[random() % mesh.positions.size()]; };
    rays::NearNodes near;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p{u(random), u(random), u(random)};
      Vec3 q{u(random), u(random), u(random)};
      if (i % 4 == 1) q = p + Vec3{0, 0, 2};
      if (i % 4 == 2) q = p + 2 * (vertex() - p);  // through a corner
      if (i % 4 == 3) q = p + 2 * (0.5 * (vertex() + vertex()) - p);
      const std::optional<int> expected = winding(internals(sites), {}, p, q);
      ASSERT_EQ(crossings(internals(sites), rays::Segment{p, q}), expected) << i;
      // From the nodes that meet a box around the segment.
      Box box;
      for (const Vec3& end : {p, q}) extend(box, internals(sites).frame.to_unit(end));
      const Vec3 margin{1e-5, 1e-5, 1e-5};
      rays::find_near_nodes(internals(sites),
                            tree::FloatBox::around({box.lower - margin, box.upper + margin}), near);
      ASSERT_EQ(crossings(internals(sites), rays::Segment{p, q}, &near), expected) << i;
    }
  }
}

// Those of pairs in lanes are separated by any plane, so that more of them are known to be apart.
TEST(Solid, FacesNearOthersAreThoseFoundOneByOne) {
  for (const test::SimdTarget target : test::simd_targets()) {
    const test::UseSimdTarget use(target);
    for (const Mesh& mesh : closed_meshes()) {
      const Sites sites(mesh);
      ASSERT_TRUE(internals(sites).is_solid());
      std::vector<std::uint8_t> flags;
      flag_faces_with_near(internals(sites), flags);
      std::vector<std::uint32_t> near;
      for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
        find_near_faces(internals(sites), f, near);
        if (flags[f] != 0) {
          EXPECT_FALSE(near.empty()) << f << " of " << mesh.triangles.size();
        } else {
          for (const std::uint32_t other : near) {
            const Corners a = unit_corners(internals(sites), f), b = unit_corners(internals(sites), other);
            EXPECT_GT(closest_or_common(a, b).squared, kClearance * kClearance) << f << " and " << other;
          }
        }
      }
    }
  }
}

TEST(Solid, FacesAtTheCornersOfBlocksAreNotNear) {
  const scenes::Blocks stairs{{{0, 0, 0}, {3, 3, 1}}, {{0, 0, 1}, {2, 3, 2}}, {{0, 0, 2}, {1, 2, 3}}};
  for (const Mesh& mesh : {scenes::plate_with_hole(2, 0.51, 1), scenes::union_of(stairs)}) {
    const Sites sites(mesh);
    std::vector<std::uint8_t> flags;
    flag_faces_with_near(internals(sites), flags);
    std::vector<std::uint32_t> near;
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
      find_near_faces(internals(sites), f, near);
      EXPECT_TRUE(near.empty()) << f;
      EXPECT_EQ(flags[f], 0) << f;
    }
  }
}

// Two triangles with a corner in common, many of whose edges are parallel or at right angles.
TEST(Solid, FacesAtAWideAngleAreNotNear) {
  std::mt19937 random(5);
  const auto corner = [&] {
    Vec3 p;
    for (double& x : p) x = static_cast<double>(random() % 3) - 1;
    return p;
  };
  const auto directions = [](const Vec3& a, const Vec3& b) {
    std::vector<Vec3> result;
    constexpr int kSteps = 100;
    for (int i = 0; i <= kSteps; ++i) result.push_back(normalized((kSteps - i) * a + double(i) * b));
    return result;
  };
  int wide = 0;
  for (int pair = 0; pair < 500; ++pair) {
    Mesh mesh;
    mesh.positions = {{}, corner(), corner(), corner(), corner()};
    mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
    const auto& p = mesh.positions;
    if (cross(p[1], p[2]) == Vec3{} || cross(p[3], p[4]) == Vec3{}) continue;
    double cosine = -1;
    for (const Vec3& a : directions(p[1], p[2]))
      for (const Vec3& b : directions(p[3], p[4])) cosine = std::max(cosine, dot(a, b));
    if (cosine > std::cos(0.1)) continue;
    ++wide;
    std::vector<std::uint32_t> near;
    const Sites sites(mesh);
    find_near_faces(internals(sites), 0, near);
    EXPECT_TRUE(near.empty()) << pair;
  }
  EXPECT_GT(wide, 100);
}

// Triangles of all sizes and shapes, near each other or not.
TEST(Solid, TrianglesKnownToBeApartAre) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&] { return Vec3{u(random), u(random), u(random)}; };
  for (const test::SimdTarget target : test::simd_targets()) {
    const test::UseSimdTarget use(target);
    std::size_t far = 0, found = 0;
    for (int round = 0; round < 2000; ++round) {
      const double size = std::pow(10.0, -6 * std::abs(u(random))),
                   clearance = round % 2 == 0 ? 4e-6 : 0.3 * size;
      TrianglePairs pairs;
      std::vector<std::array<Corners, 2>> all;
      const std::size_t count = 1 + random() % TrianglePairs::kMost;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 at = point();
        Corners a{at, at + size * point(), at + size * point()};
        if (i % 4 == 1) a[2] = a[1] + 1e-9 * (a[1] - a[0]);  // a needle
        if (i % 8 == 2) a[1] = a[2] = a[0];
        const Vec3 moved = size * point();
        Corners b{a[0] + moved, a[1] + moved, a[2] + moved + size * point()};
        if (i % 3 == 0) b = {a[1] + 0.1 * moved, a[2], a[2] + moved};
        pairs.add(a, b);
        all.push_back({a, b});
      }
      const std::uint32_t apart = pairs.apart(clearance);
      EXPECT_EQ(apart >> all.size(), 0u);
      for (std::size_t i = 0; i < all.size(); ++i) {
        const double distance = std::sqrt(closest_or_common(all[i][0], all[i][1]).squared);
        if ((apart >> i & 1u) != 0) {
          ASSERT_GT(distance, clearance) << size;
        }
        if (distance > 2 * clearance + 0.1 * size) {
          ++far;
          found += apart >> i & 1u;
        }
      }
    }
    EXPECT_GT(found, 0.9 * static_cast<double>(far));
  }
}

// The first ones are found by segments, those of later calls by the sides of faces.
TEST(Solid, FewPointsHaveTheSameSignsInEveryCall) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const Mesh& mesh : closed_meshes()) {
    const Sites sites(mesh);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < std::min<std::size_t>(200, mesh.triangles.size() - 1); ++i) {
      const Vec3 near = mesh.positions[random() % mesh.positions.size()];
      const double far = i % 2 == 0 ? 0.01 : 1;
      points.push_back(near + far * Vec3{u(random), u(random), u(random)});
    }
    const std::vector<ClosestPoint> closest = closest_points(sites, points);
    std::vector<std::uint8_t> expected;
    for (const Vec3& p : points) expected.push_back(contains(internals(sites), p) ? 1 : 0);
    const std::size_t calls = 4 + (256 + mesh.triangles.size() / 2) / points.size();
    for (std::size_t call = 0; call < calls; ++call) {
      const std::vector<std::uint8_t> flags = inside_flags(sites, points, closest, SignMethod::exact);
      for (std::size_t i = 0; i < points.size(); ++i)
        if (closest[i].distance > 1e-5) {
          ASSERT_EQ(flags[i], expected[i]) << call << ", " << i;
        }
    }
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
}  // namespace sdm::inside
