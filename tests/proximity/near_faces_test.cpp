// The faces of each surface that are near the other one, against all pairs.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "bodies/pairs/near_faces.h"
#include "geometry/triangle_pair.h"
#include "mesh/similarity.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

std::vector<bool> found(const pairs::NearFaces& near, const sites::SitesData& sites, int side) {
  std::vector<bool> faces(sites.mesh.triangles.size());
  std::size_t marked = 0;
  for (std::uint32_t leaf = 0; leaf + 1 < sites.regions.leaves.size(); ++leaf) {
    const std::uint32_t first = sites.regions.leaves[leaf];
    marked += near.of_leaf[side][leaf] != 0;
    for (std::uint32_t i = first; i < sites.regions.leaves[leaf + 1]; ++i)
      faces[sites.regions.owners[i].face] = (near.of_leaf[side][leaf] >> (i - first) & 1) != 0;
  }
  EXPECT_EQ(near.leaves[side].size(), marked);
  return faces;
}

// Compares the near faces with those of all pairs. Returns the number of faces that intersect the other
// surface.
std::size_t compare(const Mesh& a, const Mesh& b, const Transform& pose, double reach,
                    pairs::NearFacesWorkspace& workspace, pairs::NearFaces& near) {
  const Sites o1(a), o2(b);
  const pairs::MeshPair pair{internals(o1), internals(o2), mesh::Similarity::of(pose).map};
  pairs::find_near_faces(pair, reach, workspace, near);
  const std::array marks{found(near, internals(o1), 0), found(near, internals(o2), 1)};
  std::array expected{std::vector<bool>(a.triangles.size()), std::vector<bool>(b.triangles.size())};
  for (std::uint32_t i = 0; i < a.triangles.size(); ++i)
    for (std::uint32_t j = 0; j < b.triangles.size(); ++j) {
      const Corners face1 = pair.face1(i), face2 = pair.face2(j);
      if (squared_box_distance(face1, face2) > reach * reach) continue;
      if (triangles_intersect(face1, face2) || closest_points(face1, face2).squared <= reach * reach)
        expected[0][i] = expected[1][j] = true;
    }
  std::size_t intersecting = 0;
  for (const int side : {0, 1})
    for (std::size_t i = 0; i < expected[side].size(); ++i) {
      if (reach == 0)
        EXPECT_EQ(marks[side][i], expected[side][i]);
      else
        EXPECT_TRUE(marks[side][i] || !expected[side][i]);
      intersecting += reach == 0 && expected[side][i];
    }
  return intersecting;
}

TEST(NearFaces, AreThoseOfAllPairs) {
  const std::vector<Mesh> meshes{cube(0.5), placed(sphere(2), "scale:0.5"), placed(torus(16, 8), "fit"),
                                 joined(cube(0.3), moved(cube(0.25), {0.2, 0.1, 0.05}))};
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const auto pose = [&] {
    return Transform::translation({0.4 * normal(random), 0.4 * normal(random), 0.4 * normal(random)}) *
           Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
  };
  pairs::NearFacesWorkspace workspace;  // its memory is reused
  pairs::NearFaces near;
  std::size_t intersecting = 0;
  for (std::size_t trial = 0; trial < 48; ++trial) {
    SCOPED_TRACE(trial);
    const Transform placement = pose();
    for (const double reach : {0.0, 0.05, 0.5})
      intersecting += compare(meshes[trial % 4], meshes[trial / 4 % 4], placement, reach, workspace, near);
  }
  EXPECT_GT(intersecting, 500u);
}

// Two cores find two halves, one core the same in turn.
TEST(NearFaces, DoNotDependOnTheNumberOfThreads) {
  const Sites o1(placed(torus(96, 48), "fit")), o2(placed(sphere(5), "fit"));
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::array<pairs::NearFacesWorkspace, 2> workspaces;
  std::array<pairs::NearFaces, 2> near;
  std::size_t leaves = 0;
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    const Transform pose =
        Transform::translation({0.2 * normal(random), 0.2 * normal(random), 0.2 * normal(random)}) *
        Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
    const pairs::MeshPair pair{internals(o1), internals(o2), mesh::Similarity::of(pose).map};
    for (const std::size_t i : {0, 1}) {
      const ThreadLimit limit(i == 0 ? 1 : 2);
      pairs::find_near_faces(pair, trial % 3 == 2 ? 0.05 : 0, workspaces[i], near[i]);
      for (std::vector<std::uint32_t>& sorted : near[i].leaves) std::ranges::sort(sorted);
    }
    for (const std::size_t side : {0, 1}) {
      EXPECT_EQ(near[0].of_leaf[side], near[1].of_leaf[side]);
      ASSERT_EQ(near[0].leaves[side], near[1].leaves[side]);
      for (const std::uint32_t leaf : near[0].leaves[side])
        EXPECT_EQ(near[0].opposite[side][leaf], near[1].opposite[side][leaf]);
      leaves += near[0].leaves[side].size();
    }
  }
  EXPECT_GT(leaves, 5000u);
}

}  // namespace
}  // namespace sdm::test
