#include <gtest/gtest.h>
#include <sdm/mesh.h>

#include <cmath>

#include "support/shapes.h"

namespace sdm {
namespace {

TEST(Inspect, ClosedMesh) {
  const MeshInfo info = inspect(test::tetrahedron());
  EXPECT_EQ(info.vertices, 4u);
  EXPECT_EQ(info.triangles, 4u);
  EXPECT_EQ(info.edges, 6u);
  EXPECT_EQ(info.components, 1u);
  EXPECT_TRUE(info.closed && info.orientable && info.oriented && info.manifold);
  EXPECT_FALSE(info.has_uvs);
  EXPECT_NEAR(info.area, 1.5 + std::sqrt(3) / 2, 1e-15);
  EXPECT_EQ(info.bounds.upper, (Vec3{1, 1, 1}));
}

TEST(Inspect, EulerCharacteristicOfATorusIsZero) {
  const MeshInfo info = inspect(test::torus(20, 13));
  EXPECT_EQ(info.vertices + info.triangles, info.edges);
  EXPECT_TRUE(info.closed && info.oriented && info.manifold && info.has_uvs);
}

TEST(Inspect, OpenMesh) {
  Mesh mesh = test::torus(6, 5);
  mesh.triangles.pop_back();
  mesh.corner_uvs.pop_back();
  const MeshInfo info = inspect(mesh);
  EXPECT_EQ(info.boundary_edges, 3u);
  EXPECT_FALSE(info.closed);
  EXPECT_TRUE(info.orientable && info.oriented && info.manifold);
}

TEST(Inspect, BandsAndMoebiusStrips) {
  const MeshInfo plain = inspect(test::band(9, false)), crossed = inspect(test::band(9, true));
  EXPECT_TRUE(plain.orientable && plain.oriented && plain.manifold);
  EXPECT_FALSE(crossed.orientable || crossed.oriented);
  EXPECT_TRUE(crossed.manifold);
  EXPECT_EQ(plain.boundary_edges, 18u);
  EXPECT_EQ(crossed.boundary_edges, 18u);
}

TEST(Inspect, FlippedFacesAreOrientableButNotOriented) {
  Mesh mesh = test::tetrahedron();
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  const MeshInfo info = inspect(mesh);
  EXPECT_TRUE(info.closed && info.orientable && info.manifold);
  EXPECT_FALSE(info.oriented);
}

TEST(Inspect, TetrahedraThatShareAVertex) {
  Mesh mesh = test::tetrahedron();
  mesh.positions.insert(mesh.positions.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 5, 4}, {0, 4, 6}, {0, 6, 5}, {4, 5, 6}});
  const MeshInfo info = inspect(mesh);
  EXPECT_EQ(info.nonmanifold_vertices, 1u);
  EXPECT_EQ(info.nonmanifold_edges, 0u);
  EXPECT_EQ(info.components, 1u);
  EXPECT_TRUE(info.closed);
  EXPECT_FALSE(info.manifold);
}

TEST(Inspect, TetrahedraThatShareAnEdge) {
  Mesh mesh = test::tetrahedron();
  mesh.positions.insert(mesh.positions.end(), {{0, -1, 0}, {0, 0, -1}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 4, 1}, {0, 1, 5}, {0, 5, 4}, {1, 4, 5}});
  const MeshInfo info = inspect(mesh);
  EXPECT_EQ(info.nonmanifold_edges, 1u);
  EXPECT_EQ(info.nonmanifold_vertices, 2u);
  EXPECT_FALSE(info.closed || info.manifold);
}

TEST(Inspect, TwoFansOfOpenFacesAtAVertex) {
  const MeshInfo info =
      inspect({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}, {}});
  EXPECT_EQ(info.nonmanifold_vertices, 1u);
  EXPECT_EQ(info.boundary_edges, 6u);
}

TEST(Inspect, CountsDegenerateDuplicateAndUnused) {
  Mesh mesh = test::tetrahedron();
  mesh.positions.insert(mesh.positions.end(), {{2, 0, 0}, {9, 9, 9}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 1}, {2, 1, 0}, {1, 0, 2}, {0, 1, 4}});
  const MeshInfo info = inspect(mesh);
  EXPECT_EQ(info.degenerate_faces, 2u);  // a repeated corner, and three corners in line
  EXPECT_EQ(info.duplicate_faces, 2u);
  EXPECT_EQ(info.unused_vertices, 1u);
}

TEST(Inspect, DuplicatesAndRepeatedCornersLeaveAMeshClosed) {
  Mesh mesh = test::tetrahedron();
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 1}, {2, 1, 0}});
  const MeshInfo info = inspect(mesh);
  EXPECT_TRUE(info.closed && info.oriented && info.manifold);
}

TEST(Inspect, CountsComponents) {
  Mesh mesh;
  for (int k = 0; k < 5; ++k) mesh = test::joined(mesh, test::tetrahedron());
  EXPECT_EQ(inspect(mesh).components, 5u);
}

TEST(Inspect, EmptyMesh) {
  const MeshInfo info = inspect({});
  EXPECT_EQ(info.components, 0u);
  EXPECT_FALSE(info.closed);
}

}  // namespace
}  // namespace sdm
