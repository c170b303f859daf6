// Distances and collisions of pairs and of many bodies, against FCL, which has an implementation of its own.
#include "fcl_pair.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "bodies/pairs/pair_search.h"
#include "geometry/vec.h"
#include "poses.h"
#include "proximity/crowd.h"
#include "proximity/posed_pairs.h"
#include "support/every_case.h"
#include "support/map_checks.h"
#include "support/pair_oracle.h"

namespace sdm::pairs {
namespace {

class PosesByFcl : public testing::TestWithParam<test::PosedPair> {};

// FCL says -1 or 0 for surfaces that intersect. It rounds moved vertices differently: where the surfaces just
// touch, CGAL decides for exactly our triangles.
TEST_P(PosesByFcl, Agree) {
  const Mesh m1 = test::mesh_of(GetParam().o1), m2 = test::mesh_of(GetParam().o2);
  const Sites o1(m1), o2(m2);
  const bench::FclPair fcl(m1, m2);
  const oracle::CgalSurface cgal(m1);
  const double size = diagonal(bounds(m1)) + diagonal(bounds(m2));
  std::mt19937 random(7);
  PairWorkspace workspace;
  test::Disagreements distances(1e-6 * size);
  int number = 0;
  for (const Affine& pose : bench::random_poses(o1, o2, test::subset(50, 200), random)) {
    SCOPED_TRACE(number);
    const MeshPair pair{internals(o1), internals(o2), pose};
    const Separation found = find_closest(pair, 10 * size, workspace);
    distances.compare(number++, found.distance, std::max(0.0, fcl.distance(pose)));
    if (fcl.collide(pose) == found.intersecting) continue;
    EXPECT_LT(found.distance, 1e-12 * size);
    ASSERT_EQ(found.intersecting, test::cgal_says_intersect(cgal, pair));
  }
  EXPECT_TRUE(distances.none());
}

INSTANTIATE_TEST_SUITE_P(Pairs, PosesByFcl, testing::ValuesIn(test::kPosedPairs), test::name_of_pair);

TEST(MultiBodyQuery, AgreesWithFcl) {
  const std::vector<Mesh> meshes = test::crowd();
  MultiBodyQuery bodies(meshes);
  const Affine in_place;
  int apart = 0;
  for (const PairSeparation& pair : bodies.separations()) {
    const Mesh &a = meshes[pair.first], &b = meshes[pair.second];
    SCOPED_TRACE(std::to_string(pair.first) + ' ' + std::to_string(pair.second));
    const double size = diagonal(bounds(a)) + diagonal(bounds(b));
    EXPECT_NEAR(pair.separation.value, std::max(0.0, bench::FclPair(a, b).distance(in_place)), 1e-6 * size);
    apart += pair.separation.value > 0;
  }
  EXPECT_GT(apart, 15);
}

}  // namespace
}  // namespace sdm::pairs
