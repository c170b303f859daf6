// Closest points and collisions of convex solids by their support functions, against the searches of trees.
#include "bodies/convex/convex_pair.h"

#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bodies/pairs/collision.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::convex {
namespace {

std::unique_ptr<const ConvexMesh> recognised(const Mesh& mesh) {
  return recognise(internals(Sites(mesh)));
}

Mesh scaled(Mesh mesh, const Vec3& by, const Vec3& offset = {}) {
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = by[k] * p[k] + offset[k];
  return mesh;
}

Mesh without_smoothness(Mesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> factor(0.98, 1.02);
  for (Vec3& p : mesh.positions) p = factor(random) * p;
  return mesh;
}

TEST(ConvexMesh, IsRecognised) {
  EXPECT_TRUE(recognised(test::tetrahedron()));
  EXPECT_TRUE(recognised(test::cube()));
  EXPECT_TRUE(recognised(test::sphere(3)));
  EXPECT_TRUE(recognised(scaled(test::sphere(2), {1, 1e-3, 1e-3})));
  EXPECT_TRUE(recognised(scaled(test::cube(), {1, 1, 1e-6}, {1e3, 0, 0})));
  EXPECT_TRUE(recognised(test::flipped(test::sphere(1)))) << "inside out";
}

TEST(ConvexMesh, IsNoOtherMesh) {
  EXPECT_FALSE(recognised(test::torus(16, 8)));
  EXPECT_FALSE(recognised(test::band(12, false))) << "open";
  EXPECT_FALSE(recognised(test::joined(test::cube(), test::moved(test::cube(), {3, 0, 0})))) << "two pieces";
  EXPECT_FALSE(recognised(test::joined(test::cube(), test::cube(0.5)))) << "one in another";
  EXPECT_FALSE(recognised(without_smoothness(test::sphere(3), 1))) << "with dents";
  Mesh dented = test::cube();
  dented.positions[0] = 0.2 * dented.positions[0];
  EXPECT_FALSE(recognised(dented));
}

// A prism over a star {5/2}, whose outline goes round twice: no edge is reflex.
TEST(ConvexMesh, GoesRoundOnce) {
  Mesh star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 4 * std::acos(-1.0) * i / 5;
    star.positions.push_back({std::cos(angle), std::sin(angle), 0});
  }
  star.positions.push_back({0, 0, 1});
  star.positions.push_back({0, 0, -1});
  for (std::uint32_t i = 0; i < 5; ++i) {
    star.triangles.push_back({i, (i + 1) % 5, 5});
    star.triangles.push_back({(i + 1) % 5, i, 6});
  }
  EXPECT_FALSE(recognised(star));
}

TEST(ConvexMesh, IsGoneAfterARefit) {
  const Mesh ball = test::sphere(1);
  ProximityQuery query(ball, test::moved(ball, {3, 0, 0}));
  const double before = query.separation().value;
  Mesh dented = ball;
  for (Vec3& p : dented.positions)
    if (p[0] > 0.5) p[0] = 0.2;
  query.refit(dented.positions, {});
  ProximityQuery expected(dented, test::moved(ball, {3, 0, 0}));
  EXPECT_GT(query.separation().value, before);
  EXPECT_EQ(query.separation().value, expected.separation().value);
}

struct Pair {
  std::string name;
  Mesh o1, o2;
};

std::vector<Pair> pairs_of_convex_solids() {
  using test::cube, test::sphere, test::tetrahedron;
  return {{"cubes", cube(), cube(0.7)},
          {"tetrahedron and cube", tetrahedron(), cube(0.3)},
          {"ellipsoids of 20", scaled(sphere(0), {1, 0.7, 0.5}), scaled(sphere(0), {0.6, 0.9, 0.8})},
          {"ellipsoids of 320", scaled(sphere(2), {1, 0.7, 0.5}), scaled(sphere(2), {0.6, 0.9, 0.8})},
          {"ellipsoids of 1280", scaled(sphere(3), {1, 0.7, 0.5}), scaled(sphere(3), {0.6, 0.9, 0.8})},
          {"needles", scaled(sphere(1), {1, 1e-3, 1e-3}), scaled(cube(), {1e-3, 1e-4, 1})},
          {"flat boxes", scaled(cube(), {1, 1, 1e-4}), scaled(cube(), {1, 0.5, 1e-6})},
          {"of different size", scaled(sphere(2), {1e-3, 1e-3, 1e-3}), cube(2)},
          {"far from the origin", scaled(sphere(1), {1, 1, 1}, {1e6, -1e6, 3e5}),
           scaled(cube(), {1, 1, 1}, {5e5, 0, 0})},
          {"inside out", test::flipped(sphere(1)), test::flipped(cube())}};
}

class ConvexPairs : public testing::Test {
 protected:
  pairs::PairWorkspace workspace_;
  std::size_t tried_ = 0, found_ = 0, decided_ = 0;

  /// All answers that are known are those of the searches, to the bit, whatever is known from another pose.
  void expect_same(const Sites& o1, const Sites& o2, const ConvexMesh& c1, const ConvexMesh& c2,
                   const Affine& pose, double scale, Simplex& warm) {
    const pairs::MeshPair pair{internals(o1), internals(o2), pose};
    const pairs::Separation expected = pairs::find_closest(pair, kInfinity, workspace_);
    const bool colliding = pairs::colliding(pair, workspace_);
    if (expected.intersecting) {
      const pairs::Separation first = pairs::find_intersection(pair, workspace_);
      EXPECT_EQ(first.point1, expected.point1);
      EXPECT_EQ(first.face1, expected.face1);
      EXPECT_EQ(first.face2, expected.face2);
    }
    ConvexPair convex(c1, c2, pair, scale);
    for (Simplex cold; Simplex * simplex : {&cold, &warm}) {
      ++tried_;
      pairs::FacePair hint = pairs::kNoFaces;
      const auto found = convex.find_closest(kInfinity, *simplex, hint);
      if (convex.found_overlap()) {
        ++found_;
        EXPECT_TRUE(colliding);
      }
      if (found) {
        ++found_;
        EXPECT_EQ(found->distance, expected.distance);
        EXPECT_EQ(found->point1, expected.point1);
        EXPECT_EQ(found->point2, expected.point2);
        EXPECT_EQ(found->face1, expected.face1);
        EXPECT_EQ(found->face2, expected.face2);
        EXPECT_FALSE(expected.intersecting);
      }
      for (const double factor : {0.5, 0.999, 1.001}) {
        const auto within = convex.find_closest(factor * expected.distance, *simplex, hint);
        if (within && !expected.intersecting) {
          EXPECT_EQ(within->face1 != kNone, factor * expected.distance >= expected.distance) << factor;
        }
      }
      if (const auto decided = convex.colliding(*simplex)) {
        ++decided_;
        EXPECT_EQ(*decided, colliding);
      }
    }
  }
};

TEST_F(ConvexPairs, HaveTheAnswersOfSearches) {
  constexpr int kPoses = 200;
  for (const auto& [name, m1, m2] : pairs_of_convex_solids()) {
    SCOPED_TRACE(name);
    const Sites o1(m1), o2(m2);
    const auto c1 = recognise(internals(o1)), c2 = recognise(internals(o2));
    ASSERT_TRUE(c1 && c2);
    std::mt19937 random(3);
    Simplex warm;
    tried_ = found_ = decided_ = 0;
    for (const Affine& pose : bench::random_poses(o1, o2, kPoses, random))
      expect_same(o1, o2, *c1, *c2, pose, 1, warm);
    // Of five stands, one only touches, which is mostly decided, too.
    const bool extreme = name == "needles" || name == "flat boxes" || name == "far from the origin";
    EXPECT_GE(decided_, (extreme ? 6 : 9) * tried_ / 10);
    EXPECT_GE(found_, (extreme ? 4 : 9) * tried_ / 10);
  }
}

// Solids that are moved by a few roundings where they touch: by exact predicates of the features in contact.
TEST_F(ConvexPairs, AreDecidedWithinRounding) {
  for (const auto& [name, m1, m2] : pairs_of_convex_solids()) {
    if (name == "needles" || name == "flat boxes" || name == "far from the origin") continue;
    SCOPED_TRACE(name);
    const Sites o1(m1), o2(m2);
    const auto c1 = recognise(internals(o1)), c2 = recognise(internals(o2));
    std::mt19937 random(4);
    std::uniform_real_distribution<double> offset(-4e-15, 4e-15);
    Simplex warm;
    tried_ = found_ = decided_ = 0;
    std::size_t stand = 0;
    for (Affine pose : bench::random_poses(o1, o2, 100, random)) {
      if (bench::kStands[stand++ % std::size(bench::kStands)] != bench::Stand::touching) continue;
      for (int i = 0; i < 20; ++i) {
        for (double& x : pose.offset) x += (i % 2 == 0 ? 1.0 : 0.1) * offset(random);
        expect_same(o1, o2, *c1, *c2, pose, 1, warm);
      }
    }
    EXPECT_GT(tried_, 0);
    EXPECT_GE(decided_, 9 * tried_ / 10);
    EXPECT_GE(found_, 9 * tried_ / 10);
  }
}

TEST_F(ConvexPairs, HaveThemInScaledAndCoherentPoses) {
  const Mesh m1 = scaled(test::sphere(2), {1, 0.7, 0.5}), m2 = test::cube(0.5);
  const Sites o1(m1), o2(m2);
  const auto c1 = recognise(internals(o1)), c2 = recognise(internals(o2));
  Simplex warm;
  for (int i = 0; i < 300; ++i) {
    const double scale = i % 2 == 0 ? 1 : 0.3 + 0.01 * i, t = 0.01 * i;
    Transform placed =
        Transform::translation({3 - t, 0.3, 0.2 * t}) * Transform::rotation({20 * t, 70 * t, 5});
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) placed.rows[row][k] *= scale;
    const auto pose = mesh::Similarity::of(placed);
    expect_same(o1, o2, *c1, *c2, pose.map, pose.scale, warm);
  }
  EXPECT_GE(found_ + decided_, tried_);
}

// Parallel faces and edges, equal places and touching corners: whatever is answered is right.
TEST_F(ConvexPairs, HaveThemInSpecialPoses) {
  for (const Mesh& m2 : {test::cube(), test::cube(0.5), test::sphere(1), test::tetrahedron()}) {
    const Mesh m1 = test::cube();
    const Sites o1(m1), o2(m2);
    const auto c1 = recognise(internals(o1)), c2 = recognise(internals(o2));
    Simplex warm;
    for (const double x : {0.0, 0.5, 1.0, 1.5, 2.0, 2.0 + 1e-15, 2.0 + 1e-9, 2.0 - 1e-12, 3.0})
      for (const double y : {0.0, 0.25, 2.0, 2.5})
        for (const double z : {0.0, 1e-13, 2.0})
          for (const double angle : {0.0, 45.0, 90.0, 1e-7})
            expect_same(
                o1, o2, *c1, *c2,
                mesh::Similarity::of(Transform::translation({x, y, z}) * Transform::rotation({0, 0, angle}))
                    .map,
                1, warm);
  }
}

// Faces that are equally near up to rounding, of which a hint has one: the same answer as without hints.
TEST(ConvexPair, AnswersOfTiesDoNotDependOnHints) {
  const Mesh mesh = test::cube();
  Transform tilted;
  tilted.rows[0] = {0.99999999999015632, -3.5191408926469337e-06, 2.7023922144894301e-06, 0};
  tilted.rows[1] = {3.5191392767040772e-06, 0.9999999999936291, 5.9797207415736576e-07, 0};
  tilted.rows[2] = {-2.7023943188201923e-06, -5.9796256405689645e-07, 0.99999999999616973,
                    -67.749430234109084};
  ProximityQuery convex(mesh, mesh), by_trees(mesh, mesh);
  by_trees.refit(mesh.positions, mesh.positions);  // whose faces are no longer known to be convex
  convex.set_pose(1, tilted);
  by_trees.set_pose(1, tilted);
  EXPECT_EQ(convex.separation().value, by_trees.separation().value);
  EXPECT_EQ(*convex.separation().witness, *by_trees.separation().witness);
}

// How far inside all planes of the faces of a convex mesh about the origin, moved by a pose.
double depth_below_planes(const Mesh& mesh, const Transform& pose, const Vec3& p) {
  double least = kInfinity;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = pose(mesh.positions[i]), b = pose(mesh.positions[j]), c = pose(mesh.positions[k]);
    const Vec3 n = normalized(cross(b - a, c - a));
    least = std::min(least, (dot(n, a - pose({})) < 0 ? -1 : 1) * dot(n, a - p));
  }
  return least;
}
double deepest_sample(const Mesh& mesh, const Transform& pose, const Mesh& solid, const Transform& of_solid) {
  constexpr int kDivisions = 8;
  double most = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    for (int a = 0; a <= kDivisions; ++a)
      for (int b = 0; a + b <= kDivisions; ++b) {
        const double x = 1.0 * a / kDivisions, y = 1.0 * b / kDivisions;
        const Vec3 p = (1 - x - y) * mesh.positions[i] + x * mesh.positions[j] + y * mesh.positions[k];
        most = std::max(most, depth_below_planes(solid, of_solid, pose(p)));
      }
  return most;
}

// Inside a convex solid, the distance to the surface is the least height below the planes of its faces.
TEST(ConvexPair, DepthIsThatBelowThePlanesOfFaces) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Mesh flat = scaled(test::cube(), {1, 0.7, 0.05}), round = scaled(test::sphere(1), {1, 0.7, 0.5});
  const std::vector<std::pair<Mesh, Mesh>> pairs{
      {test::cube(), test::cube(0.7)}, {flat, round}, {round, test::flipped(round)}};
  for (const auto& [m1, m2] : pairs) {
    ProximityQuery query(m1, m2);
    for (int i = 0; i < 20; ++i) {
      const auto at = [&] { return 0.4 * normal(random); };
      const Transform pose = Transform::translation({at(), at(), at()}) *
                             Transform::quaternion({normal(random), normal(random), normal(random), 1});
      query.set_pose(1, pose);
      const BoundedLength& depth = *query.penetration_depth();
      EXPECT_LE(std::max(deepest_sample(m1, {}, m2, pose), deepest_sample(m2, pose, m1, {})),
                depth.upper + 1e-9);
      if (depth.value == 0) continue;
      const auto& [p1, p2] = *depth.witness;
      EXPECT_NEAR(depth.value, std::max(depth_below_planes(m2, pose, p1), depth_below_planes(m1, {}, p2)),
                  1e-9);
    }
  }
}

// A refit may make a body convex or not convex: bounds are those of the present shape.
TEST(ConvexPair, BoundsOnDepthFollowRefits) {
  const Mesh round = test::sphere(2), flat = scaled(round, {1, 0.7, 0.2});
  Mesh dented = round;
  for (std::size_t i = 0; i < 40; ++i) dented.positions[4 * i] = 0.5 * dented.positions[4 * i];
  ASSERT_TRUE(Shape(flat).convex());
  ASSERT_FALSE(Shape(dented).convex());
  const Transform pose = Transform::translation({0.6, 0.3, 0.1});
  ProximityQuery query(round, round);
  query.set_pose(1, pose);
  const BoundedLength first = *query.penetration_depth();
  for (const Mesh& m1 : {flat, dented, round})
    for (const Mesh& m2 : {dented, flat, round}) {
      query.refit(m1.positions, m2.positions);
      ProximityQuery fresh(m1, m2);
      fresh.set_pose(1, pose);
      const BoundedLength &depth = *query.penetration_depth(), &expected = *fresh.penetration_depth();
      EXPECT_GT(depth.value, 0);
      EXPECT_LE(depth.lower, expected.upper);
      EXPECT_LE(expected.lower, depth.upper);
    }
  const BoundedLength& last = *query.penetration_depth();  // of the first positions again
  EXPECT_EQ(std::tuple(last.value, last.lower, last.upper, last.witness),
            std::tuple(first.value, first.lower, first.upper, first.witness));
}

}  // namespace
}  // namespace sdm::convex
