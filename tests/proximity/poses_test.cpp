// Two surfaces in hundreds of poses, against FCL and CGAL.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <random>

#include "bodies/pairs/pair_search.h"
#include "geometry/vec.h"
#include "poses.h"
#include "proximity/posed_pairs.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm::pairs {
namespace {

void expect_witnesses(const MeshPair& pair, const Separation& s, double tolerance) {
  const auto distance_from = [](const Vec3& p, const Corners& t) { return oracle::distance({p, p, p}, t); };
  EXPECT_NEAR(norm(s.point2 - s.point1), s.distance, tolerance);
  ASSERT_LT(s.face1, pair.o1.mesh.triangles.size());
  ASSERT_LT(s.face2, pair.o2.mesh.triangles.size());
  EXPECT_LE(distance_from(s.point1, pair.face1(s.face1)), tolerance);
  EXPECT_LE(distance_from(s.point2, pair.face2(s.face2)), tolerance);
}

class Poses : public testing::TestWithParam<test::PosedPair> {};

TEST_P(Poses, AgreeWithCgal) {
  const Mesh m1 = test::mesh_of(GetParam().o1), m2 = test::mesh_of(GetParam().o2);
  const Sites o1(m1), o2(m2);
  const oracle::CgalSurface cgal(m1);
  const bool small = m2.triangles.size() < 12'000;
  const double size = diagonal(bounds(m1)) + diagonal(bounds(m2));
  std::mt19937 random(7);
  PairWorkspace workspace;
  int apart = 0, intersecting = 0;
  for (const Affine& pose : bench::random_poses(o1, o2, 200, random)) {
    const int number = apart + intersecting;
    SCOPED_TRACE(number);
    const MeshPair pair{internals(o1), internals(o2), pose};
    const Separation found = find_closest(pair, 10 * size, workspace);
    expect_witnesses(pair, found, 1e-14 * size);
    ASSERT_EQ(find_intersection(pair, workspace).intersecting, found.intersecting);
    if (found.intersecting) {
      ASSERT_EQ(found.distance, 0);
    }
    ++(found.intersecting ? intersecting : apart);
    if (small) {
      ASSERT_EQ(found.intersecting, test::cgal_says_intersect(cgal, pair));
    }
  }
  EXPECT_GT(apart, 30);
  EXPECT_GT(intersecting, 30);
}

// The contract is the same distance with every set of vector instructions, not the same bits.
TEST_P(Poses, AgreeWithEveryVectorInstructionSet) {
  const Sites o1(test::mesh_of(GetParam().o1)), o2(test::mesh_of(GetParam().o2));
  std::mt19937 random(8);
  PairWorkspace workspace;
  for (const Affine& pose : bench::random_poses(o1, o2, 10, random)) {
    const MeshPair pair{internals(o1), internals(o2), pose};
    const Separation expected = find_closest(pair, 100, workspace);
    for (const test::SimdTarget target : test::simd_targets()) {
      SCOPED_TRACE(test::name(target));
      const test::UseSimdTarget use(target);
      const Separation found = find_closest(pair, 100, workspace);
      EXPECT_EQ(found.distance, expected.distance);
      EXPECT_EQ(found.intersecting, expected.intersecting);
      EXPECT_EQ(find_intersection(pair, workspace).intersecting, expected.intersecting);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, Poses, testing::ValuesIn(test::kPosedPairs), test::name_of_pair);

}  // namespace
}  // namespace sdm::pairs
