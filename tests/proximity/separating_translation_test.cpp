// Separating translations against brute force over all directions that can be the shortest, CGAL's Minkowski
// sums, and closed forms.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "bodies/shape/body.h"
#include "geometry/vec.h"
#include "support/every_case.h"
#include "support/meshes.h"
#include "support/minkowski_oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

// An L of two unit cubes' width, from one outline, so that it does not intersect itself.
Mesh angle_bracket() {
  const std::array<Vec2, 6> outline{{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}};
  Mesh mesh;
  for (const double z : {0.0, 1.0})
    for (const Vec2& p : outline) mesh.positions.push_back({p[0], p[1], z});
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  for (const auto& [a, b, c] :
       std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({a + 6, b + 6, c + 6});
  }
  return mesh;
}

Transform random_placement(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-reach, reach);
  return Transform::translation({offset(random), offset(random), offset(random)}) *
         Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
}

// The least height of the difference of two convex bodies over the normals of its faces: those of either
// body, and across an edge of each.
double least_height(const Mesh& a, const Mesh& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto try_normal = [&](const Vec3& n) {
    const double length = norm(n);
    if (!(length > 1e-12)) return;
    for (const double sign : {1 / length, -1 / length}) {
      double far = -std::numeric_limits<double>::infinity(), near = -far;
      for (const Vec3& p : a.positions) far = std::max(far, dot(sign * n, p));
      for (const Vec3& p : b.positions) near = std::min(near, dot(sign * n, p));
      least = std::min(least, far - near);
    }
  };
  std::vector<Vec3> edges[2];
  for (int m = 0; m < 2; ++m)
    for (const auto& t : (m == 0 ? a : b).triangles) {
      const std::vector<Vec3>& p = (m == 0 ? a : b).positions;
      try_normal(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
      for (int k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3]) edges[m].push_back(p[t[(k + 1) % 3]] - p[t[k]]);
    }
  for (const Vec3& e : edges[0])
    for (const Vec3& f : edges[1]) try_normal(cross(e, f));
  return least;
}

double size_of(const Mesh& a, const Mesh& b) {
  Box box = bounds(a);
  extend(box, bounds(b));
  return diagonal(box);
}

// Coordinates of space are rounded there by more than the bounds were apart: the lower one was above the
// truth, and the result exact.
TEST(SeparatingTranslation, BoundsHoldFarFromTheOrigin) {
  for (const auto& [half, far] : {std::pair(1e-6, 1e6), std::pair(1e-3, 1e6), std::pair(1.0, 1e12)})
    for (int step = 0; step < 20; ++step) {
      SCOPED_TRACE(half);
      const Shape box(cube(half));
      ProximityQuery query(box, box);
      const double place = far + 1.5 * half * (1 + 0.003 * step);
      query.set_pose(0, Transform::translation({far, 0, 0}));
      query.set_pose(1, Transform::translation({place, 0, 0}));
      const SeparatingTranslation& found = query.separating_translation();
      const double truth = 2 * half - (place - far);
      EXPECT_LE(found.lower, truth);
      EXPECT_GE(found.upper, truth - 1e-15 * far);
      const double allowed = found.certainty == Certainty::exact ? 1e-6 * half : 1e-9 * far;
      EXPECT_NEAR(found.value, truth, allowed);
    }
}

// What holds of any two bodies.
void expect_valid(ProximityQuery& query) {
  const SeparatingTranslation found = query.separating_translation();
  ASSERT_LE(found.lower, found.upper);
  EXPECT_EQ(found.value, found.upper);
  EXPECT_DOUBLE_EQ(norm(found.translation), found.value);
  for (int k = 0; k < 3; ++k)
    EXPECT_FALSE(found.translation[k] == 0 && std::signbit(found.translation[k])) << "prints as -0";
  const bool colliding = query.colliding();
  if (const auto& depth = query.penetration_depth()) {
    EXPECT_GE(found.upper, depth->lower);
  }
  if (!colliding) {
    EXPECT_EQ(found.value, 0);
    EXPECT_EQ(found.certainty, Certainty::exact);
    return;
  }
  const Transform pose = query.pose(0);
  query.set_pose(0, Transform::translation(found.translation) * pose);
  EXPECT_FALSE(query.colliding());
  EXPECT_EQ(query.separating_translation().value, 0);
  query.set_pose(0, pose);
  EXPECT_EQ(query.separating_translation().translation, found.translation) << "the same at any time";
}

TEST(SeparatingTranslation, OfConvexBodiesIsExact) {
  const std::array bodies{cube(), tetrahedron(), sphere(0), sphere(1), box({-2, -0.1, -0.5}, {2, 0.1, 0.5})};
  std::mt19937 random(38);
  int deep = 0;
  for (int i = 0; i < 300; ++i) {
    Mesh a = bodies[i % bodies.size()], b = bodies[i / bodies.size() % bodies.size()];
    // A tenth has parallel faces and edges, or all in common.
    if (i % 10 != 0) transform(a, random_placement(random, 0.5));
    if (i % 20 != 0) transform(b, random_placement(random, 0.5));
    ProximityQuery query(a, b);
    expect_valid(query);
    if (!query.colliding()) continue;
    ++deep;
    const SeparatingTranslation& found = query.separating_translation();
    EXPECT_EQ(found.certainty, Certainty::exact);
    EXPECT_NEAR(found.value, least_height(a, b), 1e-9 * size_of(a, b)) << i;
    EXPECT_NEAR(found.lower, found.value, 1e-9 * size_of(a, b)) << i;
  }
  EXPECT_GE(deep, 270);
}

TEST(SeparatingTranslation, HasClosedForms) {
  const auto expect = [](const Mesh& a, const Mesh& b, double value, double tolerance) {
    ProximityQuery query(a, b);
    expect_valid(query);
    EXPECT_LE(query.separating_translation().lower, value + tolerance);
    EXPECT_GE(query.separating_translation().upper, value - tolerance);
    EXPECT_NEAR(query.separating_translation().value, value, tolerance);
  };
  expect(cube(), cube(), 2, 1e-9);
  expect(cube(), moved(cube(), {1.7, 0.4, 0}), 0.3, 1e-9);
  expect(cube(), cube(0.2), 1.2, 1e-9);
  // The inscribed balls of the two bodies are 0.7 % smaller than the sphere.
  expect(sphere(3), moved(sphere(3), {0, 0.3, 0.4}), 1.5, 0.03);
  expect(sphere(3), sphere(3), 2, 0.03);
  expect(cube(), moved(cube(), {2.5, 0, 0}), 0, 0);
  // An L in an L: up through the thickness, or along both sides, 1 each.
  expect(angle_bracket(), moved(angle_bracket(), {0.5, 0.5, 0}), std::sqrt(0.5), 2e-3);
}

TEST(SeparatingTranslation, OfRingsThatAreLinkedIsZero) {
  // Radii 2 and 0.2, through each other's centre.
  Mesh thin = ring(24);
  for (Vec3& p : thin.positions) {
    const double around = std::hypot(p[0], p[1]), angle = std::atan2(p[1], p[0]);
    const double radius = 1 + 0.5 * (around - 1);
    p = {radius * std::cos(angle), radius * std::sin(angle), 0.5 * p[2]};
  }
  Mesh other = thin;
  transform(other, Transform::translation({1, 0, 0}) * Transform::rotation({90, 0, 0}));
  ProximityQuery query(thin, other);
  ASSERT_FALSE(query.colliding());
  EXPECT_GT(query.separation().value, 0.1);
  EXPECT_EQ(query.separating_translation().value, 0);
  EXPECT_EQ(query.separating_translation().certainty, Certainty::exact);
}

#ifdef SDM_MINKOWSKI_ORACLE
TEST(SeparatingTranslation, OfSolidsAgreesWithMinkowskiSums) {
  const Mesh loop = ring(5), bracket = angle_bracket();
  const std::array<std::array<Mesh, 2>, 4> pairs{
      {{bracket, cube(0.6)}, {bracket, bracket}, {loop, tetrahedron()}, {loop, cube(0.4)}}};
  std::mt19937 random(4);
  std::size_t compared = 0;
  for (const auto& [a, b] : pairs) {
    for (std::size_t i = 0; i < subset(1, 2); ++i) {
      Mesh first = a, second = b;
      const Vec3 middle = centre(bounds(a));
      for (Vec3& p : first.positions) p = p - middle + Vec3{0.5, 0.2, 0.1};
      transform(second, random_placement(random, 0.4));
      ProximityQuery query(first, second);
      expect_valid(query);
      if (!query.colliding()) continue;
      ++compared;
      const double truth = oracle::separating_distance(first, second);
      const SeparatingTranslation& found = query.separating_translation();
      const double rounding = 1e-6 * size_of(first, second);
      EXPECT_LE(found.lower, truth + rounding);
      EXPECT_GE(found.upper, truth - rounding);
      EXPECT_LE(found.upper, 1.3 * truth);
    }
  }
  EXPECT_GE(compared, subset(4, 8));
}
#endif

// Ten pairs of non-convex bodies, overlapping by little and by much.
TEST(SeparatingTranslation, OfOtherBodiesHasCloseBounds) {
  const std::array names{"bunny.obj", "elephant.off", "cow.off", "hand.off", "knot1.off"};
  std::mt19937 random(1);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < 10; ++i) {
    const Shape a(load(names[i % 5], "fit")), b(load(names[(i + 1 + i / 5) % 5], "fit"));
    ProximityQuery query(a, b);
    for (int k = 0; k < 4; ++k) {
      query.set_pose(0, Transform::translation({0.1 * k, 0.03, 0.1 * k}));
      query.set_pose(1, random_placement(random, 0.1));
      expect_valid(query);
      if (!query.colliding()) continue;
      const SeparatingTranslation& found = query.separating_translation();
      ASSERT_GT(found.lower, 0);
      ratios.push_back(found.upper / found.lower);
    }
  }
  ASSERT_GT(ratios.size(), 30u);
  std::ranges::sort(ratios);
  EXPECT_LE(ratios[ratios.size() / 2], 1.4);
}

TEST(SeparatingTranslation, OfOpenSurfacesIsVerified) {
  ProximityQuery query(square(2, 0), placed(square(2, 0), "rotate:80:0:10"));
  ASSERT_TRUE(query.colliding());
  expect_valid(query);
  EXPECT_EQ(query.separating_translation().lower, 0);
  EXPECT_GT(query.separating_translation().upper, 0);
  ProximityQuery in_solid(square(0.5, 0.2), cube());
  expect_valid(in_solid);
  EXPECT_NEAR(in_solid.separating_translation().value, 0.8, 1e-3);
  EXPECT_GT(in_solid.separating_translation().lower, 0.7);
}

// Boxes without a side and hollow ones, hulls and tori, one of a pair often smaller.
TEST(SeparatingTranslation, CannotBeShortenedAlongItself) {
  const auto stretched = [](Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) p = {by[0] * p[0], by[1] * p[1], by[2] * p[2]};
    return mesh;
  };
  Mesh without_side = cube(0.5);
  without_side.triangles.erase(without_side.triangles.begin(), without_side.triangles.begin() + 2);
  const std::array<Shape, 4> shapes{Shape(without_side), Shape(joined(cube(0.5), flipped(cube(0.4)))),
                                    Shape(stretched(sphere(0), {0.6, 0.45, 0.5})),
                                    Shape(stretched(torus(16, 8), {0.35, 0.35, 0.25}))};
  std::mt19937 random(77);
  int bounded = 0;
  for (int i = 0; i < 240; ++i) {
    ProximityQuery query(shapes[i % 4], shapes[i / 4 % 4]);
    const Transform pose = random_placement(random, 0.6) * Transform::scaling(i % 3 == 0 ? 0.3 : 1);
    query.set_pose(0, pose);
    const SeparatingTranslation found = query.separating_translation();
    if (found.certainty == Certainty::exact) continue;
    ++bounded;
    query.set_pose(0, Transform::translation((1 - 5e-3) * found.translation) * pose);
    EXPECT_TRUE(query.colliding()) << i;
  }
  EXPECT_GE(bounded, 200);
}

TEST(SeparatingTranslation, FollowsScaledPoses) {
  const Shape box(cube());
  ProximityQuery query(box, box);
  query.set_pose(0, Transform::translation({100, 0, 0}) * Transform::scaling(3));
  query.set_pose(1, Transform::translation({103, 0.5, 0}) * Transform::scaling(0.5));
  expect_valid(query);
  EXPECT_NEAR(query.separating_translation().value, 0.5, 1e-9);
  EXPECT_NEAR(query.separating_translation().translation[0], -0.5, 1e-9);
}

void expect_equal(ProximityQuery& query, ProximityQuery expected) {
  const SeparatingTranslation &found = query.separating_translation(),
                              &fresh = expected.separating_translation();
  EXPECT_EQ(found.certainty, fresh.certainty);
  EXPECT_NEAR(found.lower, fresh.lower, 1e-9);
  EXPECT_NEAR(found.upper, fresh.upper, 1e-9);
}

using Cell = std::array<int, 3>;

// The surface of unit cubes with common vertices, without the sides between them.
Mesh of_cells(const std::set<Cell>& cells, const Cell& at) {
  Mesh mesh;
  std::map<Cell, std::uint32_t> numbers;
  const auto vertex = [&](const Cell& p) {
    const auto [number, added] = numbers.emplace(p, static_cast<std::uint32_t>(mesh.positions.size()));
    if (added) mesh.positions.push_back({1.0 * p[0] + at[0], 1.0 * p[1] + at[1], 1.0 * p[2] + at[2]});
    return number->second;
  };
  for (const Cell& cell : cells)
    for (int k = 0; k < 3; ++k)
      for (const int side : {0, 1}) {
        Cell beside = cell;
        beside[k] += 2 * side - 1;
        if (cells.contains(beside)) continue;
        std::array<std::uint32_t, 4> corner;
        for (int i = 0; i < 4; ++i) {
          Cell p = cell;
          p[k] += side;
          p[(k + 1) % 3] += i == 1 || i == 2;
          p[(k + 2) % 3] += i / 2;
          corner[side == 1 ? i : 3 - i] = vertex(p);
        }
        mesh.triangles.push_back({corner[0], corner[1], corner[2]});
        mesh.triangles.push_back({corner[0], corner[2], corner[3]});
      }
  return mesh;
}

// Touching bodies have a deepest point whose distance is rounding, or 0, along no direction.
TEST(SeparatingTranslation, OfBodiesThatTouchIsZeroAtAnyPlace) {
  std::mt19937 random(2);
  const auto any = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto cells = [&] {
    std::vector<Cell> grown{{}};
    for (int i = any(0, 4); i > 0; --i) {
      Cell next = grown[static_cast<std::size_t>(any(0, static_cast<int>(grown.size()) - 1))];
      next[any(0, 2)] += 2 * any(0, 1) - 1;
      grown.push_back(next);
    }
    return std::set(grown.begin(), grown.end());
  };
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const std::set<Cell> a = cells(), b = cells();
    const Cell at{any(-2, 2), any(-2, 2), any(-2, 2)};
    const bool common = std::ranges::any_of(b, [&](const Cell& c) {
      return a.contains({c[0] + at[0], c[1] + at[1], c[2] + at[2]});
    });
    // Sheared by integers, so that most faces are in no plane of coordinates.
    std::array<Mesh, 2> meshes{of_cells(a, {}), of_cells(b, at)};
    if (i % 2 == 1)
      for (Mesh& mesh : meshes)
        for (Vec3& p : mesh.positions) p = {3 * p[0] + p[1] - p[2], p[0] + 2 * p[1], p[2] - p[0] + p[1]};
    for (const int place : {0, 10, 999'983, 1'000'000}) {
      SCOPED_TRACE(::testing::Message() << "bodies " << i << " at " << place);
      const Vec3 by{1.0 * place, 1.0 * place, 1.0 * place};
      ProximityQuery query(moved(meshes[0], by), moved(meshes[1], by));
      if (!query.colliding()) continue;
      expect_valid(query);
      EXPECT_FALSE(query.separating_contacts().empty());
      if (common) continue;
      ++touching;
      EXPECT_EQ(query.separating_translation().lower, 0);
      EXPECT_LE(query.separating_translation().upper, 1e-7);
    }
  }
  EXPECT_GE(touching, 50);
}

TEST(SeparatingTranslation, DoesNotKeepAShapeFromDeforming) {
  const Mesh box = cube();
  ProximityQuery query(box, moved(box, {0.5, 0, 0}));
  EXPECT_NEAR(query.separating_translation().value, 1.5, 1e-9);
  query.refit(moved(box, {0.2, 0, 0}).positions, {});
  EXPECT_NEAR(query.separating_translation().value, 1.7, 1e-9);
  // A dent makes it another body.
  Mesh dented = sphere(2);
  ProximityQuery balls(dented, sphere(2));
  EXPECT_EQ(balls.separating_translation().certainty, Certainty::exact);
  dented.positions[20] = 0.2 * dented.positions[20];
  balls.refit(dented.positions, {});
  expect_valid(balls);
  EXPECT_GT(internals(Shape(dented))->convexity_deficit(), 1e-3);
  EXPECT_EQ(balls.separating_translation().certainty, Certainty::bounded);
  expect_equal(balls, ProximityQuery(dented, sphere(2)));
  // Of a smaller body, the balls are smaller.
  const Mesh loop = ring(12);
  ProximityQuery loops(loop, moved(loop, {0.3, 0.2, 0.1}));
  const double lower = loops.separating_translation().lower;
  std::array<Mesh, 2> thin{loop, moved(loop, {0.3, 0.2, 0.1})};
  for (Mesh& mesh : thin)
    for (Vec3& p : mesh.positions) p[2] *= 0.5;
  loops.refit(thin[0].positions, thin[1].positions);
  expect_valid(loops);
  EXPECT_LT(loops.separating_translation().lower, 0.9 * lower);
  // A refit keeps the tree, by which the balls are found: the same of bodies that had none before.
  ProximityQuery refitted(loop, moved(loop, {0.3, 0.2, 0.1}));
  refitted.refit(thin[0].positions, thin[1].positions);
  expect_equal(loops, std::move(refitted));
}

TEST(Convexity, IsDecidedExactly) {
  const auto deficit = [](const Mesh& mesh) { return internals(Shape(mesh))->convexity_deficit(); };
  const auto convex = [&](const Mesh& mesh) { return deficit(mesh) == 0; };
  EXPECT_TRUE(convex(cube()));
  EXPECT_TRUE(convex(tetrahedron()));
  EXPECT_TRUE(convex(sphere(3)));
  EXPECT_TRUE(convex(moved(cube(), {1e6, -1e6, 3})));
  EXPECT_TRUE(convex(flipped(cube())));
  EXPECT_FALSE(convex(ring(12)));
  EXPECT_FALSE(convex(angle_bracket()));
  EXPECT_FALSE(convex(joined(cube(), moved(cube(), {5, 0, 0}))));
  EXPECT_FALSE(convex(single_triangle()));
  EXPECT_FALSE(convex(square(1, 0)));
  // Half of a side, cut at a point of its plane, and at one that is nearest to it on either side: a hill
  // beside the other half is not convex either.
  for (const double height : {1.0, std::nextafter(1.0, 2.0), std::nextafter(1.0, 0.0)}) {
    Mesh cut = cube();
    const std::size_t top =
        static_cast<std::size_t>(std::ranges::find_if(cut.triangles,
                                                      [&](const auto& t) {
                                                        return std::ranges::all_of(t, [&](auto v) {
                                                          return cut.positions[v][2] == 1;
                                                        });
                                                      }) -
                                 cut.triangles.begin());
    const auto [a, b, c] = cut.triangles[top];
    const auto added = static_cast<std::uint32_t>(cut.positions.size());
    Vec3 middle = (1.0 / 4) * cut.positions[a] + (1.0 / 4) * cut.positions[b] + (1.0 / 2) * cut.positions[c];
    middle[2] = height;
    cut.positions.push_back(middle);
    cut.triangles[top] = {a, b, added};
    cut.triangles.push_back({b, c, added});
    cut.triangles.push_back({c, a, added});
    EXPECT_EQ(convex(cut), height == 1) << height;
    EXPECT_LE(deficit(cut), 1e-14);
  }
}

}  // namespace
}  // namespace sdm::test
