// Properties of the closest points of any two surfaces.
#include "bodies/pairs/pair_search.h"

#include <sdm/sdm.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/triangle_pair.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "support/allocations.h"
#include "support/meshes.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"

namespace sdm::pairs {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

Separation closest(const Mesh& m1, const Mesh& m2, const Affine& pose = {}, double bound = kAny) {
  const Sites o1(m1), o2(m2);
  PairWorkspace workspace;
  return find_closest({internals(o1), internals(o2), pose}, bound, workspace);
}

Mesh moved(Mesh mesh, const Affine& pose) {
  for (Vec3& p : mesh.positions) p = pose(p);
  return mesh;
}

Affine shift(double x, double y = 0, double z = 0) {
  return {.offset = {x, y, z}};
}

double brute_force(const Mesh& m1, const Mesh& m2, const Affine& pose) {
  const Sites o1(m1), o2(m2);
  const MeshPair pair{internals(o1), internals(o2), pose};
  double least = kAny;
  for (std::uint32_t f = 0; f < m1.triangles.size(); ++f)
    for (std::uint32_t g = 0; g < m2.triangles.size(); ++g)
      least = std::min(least, oracle::distance(pair.face1(f), pair.face2(g)));
  return least;
}

// Large triangles, with needles, segments and points among them.
Mesh soup_with_defects(std::size_t triangles, std::mt19937& random) {
  Mesh mesh = test::soup(triangles, random);
  for (std::size_t f = 0; f < triangles; ++f) {
    Vec3* p = &mesh.positions[3 * f];
    for (int k = 1; k < 3; ++k) p[k] = p[0] + 3.0 * (p[k] - p[0]);
  }
  for (std::size_t f = 0; f + 3 < triangles; f += 4) {
    Vec3* p = &mesh.positions[3 * f];
    p[2] = 0.5 * (p[0] + p[1]);          // a segment
    p[5] = p[4] = p[3];                  // a point
    p[8] = p[7] + 1e-9 * (p[8] - p[7]);  // a needle
  }
  return mesh;
}

TEST(PairSearch, AgreesWithBruteForceOnSoups) {
  std::mt19937 random(3);
  int apart = 0;
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    const Mesh m1 = soup_with_defects(24, random), m2 = soup_with_defects(20, random);
    Affine pose = bench::random_rotation(random);
    const Vec3 middle{0.5, 0.5, 0.5};
    pose.offset = middle - pose(middle) + Vec3{0.3 * (i % 6), 0, 0};
    // Any affine map will do: one that shears and mirrors, and one that makes O2 tiny.
    if (i % 3 == 1) pose.rows[0] = -1.5 * pose.rows[0] + 0.4 * pose.rows[1];
    if (i % 3 == 2)
      for (Vec3& row : pose.rows) row = 1e-7 * row;
    const double expected = brute_force(m1, m2, pose);
    const Separation found = closest(m1, m2, pose);
    EXPECT_NEAR(found.distance, expected, 1e-14);
    EXPECT_EQ(found.intersecting, expected == 0);
    apart += !found.intersecting;
  }
  EXPECT_GT(apart, 8);
  EXPECT_LT(apart, 20);
}

TEST(PairSearch, PoseEqualsMovedMesh) {
  std::mt19937 random(4);
  const Mesh m1 = test::load("pig.off", "fit"), m2 = test::load("head.off", "fit");
  for (int i = 0; i < 20; ++i) {
    Affine pose = bench::random_rotation(random);
    pose.offset = {0.2 * i, 0.1, 0};
    const Separation posed = closest(m1, m2, pose), expected = closest(m1, moved(m2, pose));
    EXPECT_EQ(posed.distance, expected.distance);  // the same triangles, to the bit
    EXPECT_EQ(posed.intersecting, expected.intersecting);
  }
}

TEST(PairSearch, IsSymmetric) {
  std::mt19937 random(5);
  const Mesh m1 = test::load("hand.off", "fit"), m2 = test::load("head.off", "fit");
  for (int i = 0; i < 20; ++i) {
    Affine pose = bench::random_rotation(random);
    pose.offset = {0.2 * i, 0, 0.1};
    const Mesh there = moved(m2, pose);
    const Separation one = closest(m1, there), other = closest(there, m1);
    EXPECT_NEAR(one.distance, other.distance, 1e-15);
    EXPECT_EQ(one.intersecting, other.intersecting);
  }
}

TEST(PairSearch, RigidMotionOfBothChangesNothing) {
  std::mt19937 random(6);
  const Mesh m1 = test::load("cow.off", "fit"), m2 = test::load("star.off", "fit,translate:0.7:0.4:0");
  const double expected = closest(m1, m2).distance;
  ASSERT_GT(expected, 0.01);
  for (int i = 0; i < 20; ++i) {
    Affine motion = bench::random_rotation(random);
    motion.offset = {std::pow(10.0, i % 6), 3, -2};
    const Mesh there1 = moved(m1, motion), there2 = moved(m2, motion);
    EXPECT_NEAR(closest(there1, there2).distance, expected, 1e-15 * (10 + norm(motion.offset)));
    EXPECT_NEAR(closest(m1, moved(m2, motion), inverse(motion)).distance, expected,
                1e-14 * (10 + norm(motion.offset)));
  }
}

// Spheres and cubes have many pairs of faces at the smallest distance, which share a vertex or an edge.
TEST(PairSearch, HintsChangeNoBit) {
  std::mt19937 random(9);
  for (const Mesh& mesh : {test::sphere(3), test::cube(), test::torus(12, 8)}) {
    const Sites o1(mesh), o2(mesh);
    for (int i = 0; i < 12; ++i) {
      Affine pose = i % 2 == 0 ? Affine{} : bench::random_rotation(random);
      pose.offset = {3 + 0.5 * (i % 4), 0.1 * (i % 3), 0};
      const MeshPair pair{internals(o1), internals(o2), pose};
      PairWorkspace workspace;
      const Separation expected = find_closest(pair, kAny, workspace);
      for (int hint = 0; hint < 20; ++hint) {
        const auto face = [&] { return static_cast<std::uint32_t>(random() % mesh.triangles.size()); };
        const FacePair faces = hint == 0 && expected.face1 != kNone ? FacePair{expected.face1, expected.face2}
                                                                    : FacePair{face(), face()};
        const Separation found = find_closest(pair, kAny, workspace, faces);
        ASSERT_EQ(found.distance, expected.distance);
        ASSERT_EQ(found.point1, expected.point1);
        ASSERT_EQ(found.point2, expected.point2);
        ASSERT_EQ(found.face1, expected.face1);
        ASSERT_EQ(found.face2, expected.face2);
      }
    }
  }
}

// Small bodies at distances, and with coordinates, of up to a million times their size: rounding is then far
// more than of their size. Closest faces that were known before are found again.
TEST(PairSearch, HintsChangeNoBitFarAway) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    return size * Vec3{normal(random), normal(random), normal(random)};
  };
  const std::vector<Mesh> meshes{test::cube(), test::sphere(1), test::single_triangle(),
                                 test::soup(10, random), test::fan(20)};
  for (int i = 0; i < 240; ++i) {
    SCOPED_TRACE(i);
    const double far = std::pow(10, i % 6 + 1);
    Mesh m1 = meshes[i % meshes.size()], m2 = meshes[i / 5 % meshes.size()];
    const Affine placed = mesh::Similarity::of(Transform::translation(vector(i % 2 == 0 ? far : 0))).map;
    m1 = moved(m1, placed);
    const Affine pose =
        mesh::Similarity::of(
            Transform::translation(placed.offset + vector(i % 3 == 0 ? 3 : far)) *
            Transform::quaternion({normal(random), normal(random), normal(random), normal(random)}))
            .map;
    const Sites o1(m1), o2(m2);
    const MeshPair pair{internals(o1), internals(o2), pose};
    PairWorkspace workspace;
    const Separation expected = find_closest(pair, kAny, workspace);
    ASSERT_NE(expected.face1, kNone);
    EXPECT_NEAR(expected.distance, brute_force(m1, m2, pose), 1e-14 * (10 + 4 * far));
    for (int hint = 0; hint < 10; ++hint) {
      const auto face = [&](const Mesh& mesh) {
        return static_cast<std::uint32_t>(random() % mesh.triangles.size());
      };
      const FacePair faces =
          hint == 0 ? FacePair{expected.face1, expected.face2} : FacePair{face(m1), face(m2)};
      const Separation found = find_closest(pair, kAny, workspace, faces);
      ASSERT_EQ(found.distance, expected.distance);
      ASSERT_EQ(found.face1, expected.face1);
      ASSERT_EQ(found.face2, expected.face2);
    }
  }
}

// Boxes alone give the same results, for bodies that are far apart, close and intersecting.
TEST(PairSearch, CylindersChangeNoBit) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  const std::vector<Mesh> meshes{test::sphere(4), test::height_field(40), test::torus(60, 30),
                                 test::with_defects(test::sphere(4))};
  for (std::size_t i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Mesh &m1 = meshes[i % meshes.size()], &m2 = meshes[i / meshes.size() % meshes.size()];
    const Sites o1(m1), o2(m2);
    const sites::CylinderTree cylinders1(internals(o1).wide, internals(o1).regions),
        cylinders2(internals(o2).wide, internals(o2).regions);
    ASSERT_FALSE(cylinders1.nodes.empty());
    Affine pose = bench::random_rotation(random);
    for (double& x : pose.offset) x = 0.3 * static_cast<double>(i % 5) * normal(random);
    PairWorkspace workspace;
    const MeshPair plain{internals(o1), internals(o2), pose},
        pair{internals(o1), internals(o2), pose, {&cylinders1, &cylinders2}};
    const Separation found = find_closest(pair, kAny, workspace),
                     expected = find_closest(plain, kAny, workspace);
    EXPECT_EQ(found.distance, expected.distance);
    EXPECT_EQ(found.point1, expected.point1);
    EXPECT_EQ(found.face1, expected.face1);
    EXPECT_EQ(found.face2, expected.face2);
    EXPECT_EQ(find_intersection(pair, workspace).face1, find_intersection(plain, workspace).face1);
  }
}

// Bodies that a plane separates, closed, open, folded and with defects, close to each other and far apart:
// only leaves near the plane are compared.
TEST(PairSearch, FindsTheClosestFacesAcrossAPlane) {
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  const std::vector<Mesh> meshes{test::sphere(2), test::height_field(8), test::torus(12, 6),
                                 test::with_defects(test::sphere(1)), soup_with_defects(60, random)};
  for (std::size_t i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const Mesh &m1 = meshes[i % meshes.size()], &m2 = meshes[i / meshes.size() % meshes.size()];
    Affine pose = bench::random_rotation(random);
    const Vec3 towards = normalized(Vec3{normal(random), normal(random), normal(random)});
    // Apart by this along the direction.
    const double gap = std::array{0.0, 1e-6, 0.01, 0.3, 3.0}[i % 5];
    double end1 = -kAny, end2 = kAny;
    for (const Triangle& t : m1.triangles)
      for (const std::uint32_t v : t) end1 = std::max(end1, dot(towards, m1.positions[v]));
    for (const Triangle& t : m2.triangles)
      for (const std::uint32_t v : t) end2 = std::min(end2, dot(towards, pose(m2.positions[v])));
    pose.offset = (end1 - end2 + gap) * towards;
    const Sites o1(m1), o2(m2);
    const MeshPair pair{internals(o1), internals(o2), pose};
    double expected = kAny;
    for (std::uint32_t f = 0; f < m1.triangles.size(); ++f)
      for (std::uint32_t g = 0; g < m2.triangles.size(); ++g)
        expected = std::min(expected, std::sqrt(closest_or_common(pair.face1(f), pair.face2(g)).squared));
    PairWorkspace workspace;
    const Separation found = find_closest(pair, kAny, workspace);
    EXPECT_NEAR(found.distance, expected, 1e-14);
    for (int hint = 0; hint < 10; ++hint) {
      const auto face = [&](const Mesh& mesh) {
        return static_cast<std::uint32_t>(random() % mesh.triangles.size());
      };
      for (const double bound : {kAny, 1.01 * expected + 1e-9, 0.99 * expected - 1e-9}) {
        const Separation other =
            bound < 0 ? Separation{} : find_closest(pair, bound, workspace, {face(m1), face(m2)});
        if (bound < expected) {
          EXPECT_EQ(other.face1, kNone);
          continue;
        }
        ASSERT_EQ(other.distance, found.distance);
        ASSERT_EQ(other.point1, found.point1);
        ASSERT_EQ(other.face1, found.face1);
        ASSERT_EQ(other.face2, found.face2);
      }
    }
  }
}

TEST(PairSearch, RespectsTheBound) {
  const Mesh m1 = test::load("pig.off", "fit"), m2 = test::load("cow.off", "fit");
  const Affine pose = shift(1.3, 0.2);
  const Separation all = closest(m1, m2, pose);
  ASSERT_GT(all.distance, 0.1);
  for (const double bound : {all.distance, std::nextafter(all.distance, 1), 2 * all.distance}) {
    const Separation found = closest(m1, m2, pose, bound);
    EXPECT_EQ(found.distance, all.distance);
    EXPECT_NE(found.face1, kNone);
  }
  for (const double bound : {0.0, 0.5 * all.distance, std::nextafter(all.distance, 0)}) {
    const Separation none = closest(m1, m2, pose, bound);
    EXPECT_EQ(none.distance, kAny);
    EXPECT_EQ(none.face1, kNone);
    EXPECT_EQ(none.face2, kNone);
  }
}

TEST(PairSearch, IdenticalAndCoplanar) {
  const Mesh pig = test::load("pig.off", "fit"), cube = test::cube();
  EXPECT_TRUE(closest(pig, pig).intersecting);
  EXPECT_TRUE(closest(cube, cube).intersecting);
  EXPECT_TRUE(closest(cube, cube, shift(2, 0.3, 0.2)).intersecting) << "side on side";
  EXPECT_TRUE(closest(cube, cube, shift(2, 2, 0.2)).intersecting) << "edge on edge";
  EXPECT_TRUE(closest(cube, cube, shift(2, 2, 2)).intersecting) << "corner on corner";
  const double beyond = std::nextafter(2.0, 3.0);
  for (const Affine& pose : {shift(beyond, 0.3, 0.2), shift(0.3, 0, beyond)}) {
    const Separation found = closest(cube, cube, pose);
    EXPECT_FALSE(found.intersecting);
    EXPECT_GT(found.distance, 0);
    EXPECT_LT(found.distance, 1e-15);
  }
}

// Details of 1e-3 in coordinates of 1e5: a float there resolves 1e-2.
TEST(PairSearch, FineDetailsFarFromTheOrigin) {
  Mesh cloud = test::sphere(3);
  for (Vec3& p : cloud.positions) p = 1e-3 * p;
  Mesh wide = cloud;  // 1e5 wide: a grain at either end
  for (const double x : {-1e5, 1e5}) wide = test::joined(wide, moved(cloud, shift(x, x, 0)));
  const Separation found = closest(wide, wide, shift(0, 3e-3, 0));
  EXPECT_NEAR(found.distance, 1e-3, 1e-5);
  EXPECT_FALSE(found.intersecting);
  EXPECT_TRUE(closest(wide, wide, shift(0, 1e-3, 0)).intersecting);
}

TEST(PairSearch, MeshesOfVeryDifferentSizes) {
  const Mesh sphere = test::sphere(2);
  for (const double scale : {1e-4, 1e-9, 1e-18, 1e-21, 1e-28}) {
    SCOPED_TRACE(scale);
    Mesh grain = sphere;
    for (Vec3& p : grain.positions) p = scale * p;
    const Vec3 at{1.5, 0.2, -0.3};
    const Sites sites(sphere);
    const double expected = closest_points(sites, std::vector{at})[0].distance;
    const Affine pose{.offset = at}, back{.offset = -at};
    EXPECT_NEAR(closest(sphere, grain, pose).distance, expected, 2 * scale + 1e-15);
    EXPECT_NEAR(closest(grain, sphere, back).distance, expected, 2 * scale + 1e-15);
    EXPECT_TRUE(closest(grain, grain).intersecting);
  }
}

// Poses that flatten O2, or whose inverse overflows single precision, are valid.
TEST(PairSearch, SingularPoses) {
  const Mesh sphere = test::sphere(2);
  Affine flat = shift(3);
  flat.rows[0] = {};
  EXPECT_NEAR(closest(sphere, sphere, flat).distance, 2, 1e-12);
  flat.rows[0] = {1e-30, 0, 0};
  EXPECT_NEAR(closest(sphere, sphere, flat).distance, 2, 1e-12);
  flat.rows = {};
  EXPECT_NEAR(closest(sphere, sphere, flat).distance, 2, 1e-12);
}

TEST(PairSearch, FacesThatTouchAreFoundAmongMany) {
  // Two sheets a thousandth apart, one with a spike that just touches the other.
  Mesh sheet;
  constexpr std::uint32_t n = 60;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) sheet.positions.push_back({double(i) / n, double(j) / n, 0});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      sheet.triangles.push_back({a, b, b + 1});
      sheet.triangles.push_back({a, b + 1, a + 1});
    }
  Mesh spiked = moved(sheet, shift(0.003, 0.004, 1e-3));
  EXPECT_NEAR(closest(sheet, spiked).distance, 1e-3, 1e-15);
  Vec3& tip = spiked.positions[1234];
  tip[2] = 1e-300;
  EXPECT_FALSE(closest(sheet, spiked).intersecting);
  tip[2] = 0;
  const Separation found = closest(sheet, spiked);
  EXPECT_TRUE(found.intersecting);
  EXPECT_NEAR(norm(found.point1 - tip), 0, 1e-12);
}

TEST(PairSearch, AllocatesNothingAfterTheFirstSearches) {
  const Sites o1(test::load("hand.off", "fit")), o2(test::load("head.off", "fit"));
  std::mt19937 random(9);
  const std::vector<Affine> poses = bench::random_poses(o1, o2, 20, random);
  PairWorkspace workspace;
  const auto run = [&] {
    for (const Affine& pose : poses) {
      (void)find_closest({internals(o1), internals(o2), pose}, kAny, workspace);
      (void)find_intersection({internals(o1), internals(o2), pose}, workspace);
    }
  };
  run();
  const std::size_t before = test::allocations();
  run();
  EXPECT_EQ(test::allocations(), before);
}

// Results do not depend on earlier uses of the workspace.
TEST(PairSearch, DoesNotDependOnEarlierSearches) {
  const Sites o1(test::load("hand.off", "fit")), o2(test::load("head.off", "fit"));
  std::mt19937 random(10);
  PairWorkspace used;
  for (const Affine& pose : bench::random_poses(o1, o2, 10, random)) {
    PairWorkspace fresh;
    const MeshPair pair{internals(o1), internals(o2), pose};
    const Separation a = find_closest(pair, kAny, used), b = find_closest(pair, kAny, fresh);
    EXPECT_EQ(a.point1, b.point1);
    EXPECT_EQ(a.point2, b.point2);
    EXPECT_EQ(a.face1, b.face1);
    EXPECT_EQ(a.face2, b.face2);
  }
}

}  // namespace
}  // namespace sdm::pairs
