// What is found of meshes themselves and made of them: one small case for each.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/oracle.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

TEST(SmokeMeshes, InspectionCountsWhatIsThere) {
  const MeshInfo closed = inspect(torus(7, 5));
  EXPECT_EQ(closed.edges, 105u);
  EXPECT_TRUE(closed.closed && closed.orientable && closed.oriented && closed.manifold && closed.has_uvs);
  const MeshInfo apart = inspect(taken_apart(cube(), 0));
  EXPECT_EQ(apart.components, 12u);
  EXPECT_EQ(apart.boundary_edges, 36u);
  EXPECT_NEAR(apart.area, 24, 1e-12);
  EXPECT_FALSE(inspect(band(9, true)).orientable);
  EXPECT_TRUE(inspect(band(9, false)).orientable);
  const MeshInfo bad = inspect(with_defects(torus(5, 4)));
  EXPECT_GT(bad.nonmanifold_edges + bad.duplicate_faces, 0u);
  Mesh empty;
  EXPECT_THROW(validate(empty), Error);
  validate(single_triangle());
  EXPECT_EQ(bounds(cube()).upper, (Vec3{1, 1, 1}));
}

TEST(SmokeMeshes, TransformsAreUndoneByTheirInverses) {
  const Transform map = Transform::translation({1, 2, 3}) * Transform::rotation({30, 40, 50}) *
                        Transform::scaling(2) * Transform::quaternion({1, 0.5, -0.25, 2});
  const Vec3 p{0.3, -0.7, 11};
  EXPECT_LT(norm(map.inverse()(map(p)) - p), 1e-12);
  EXPECT_NEAR(map.determinant(), 8, 1e-12);
  EXPECT_EQ(map.orientation(), 1);
  EXPECT_LT(norm(Transform::scaling(3).normal({0, 0, 2}) - Vec3{0, 0, 1}), 1e-12);
  Mesh mesh = torus(5, 3);
  transform(mesh, fit_to_unit(mesh));
  const Box box = bounds(mesh);
  EXPECT_NEAR(std::max(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1]), 1, 1e-12);
  Transform mirror;
  mirror.rows[2][2] = -1;
  transform(mesh, mirror);
  EXPECT_GT(solid_volume(Sites(mesh)).value, 0);
  EXPECT_TRUE(inspect(mesh).oriented);
}

TEST(SmokeMeshes, WeldingClosesWhatRoundingOpened) {
  for (const Mesh& mesh : {cube(), sphere(1), torus(7, 5)}) {
    const Mesh apart = taken_apart(mesh, 1e-6);
    const Welded welded = weld(apart, {.tolerance = 1e-4});
    EXPECT_EQ(welded.boundary_edges, 0u);
    EXPECT_EQ(welded.joined_vertices, apart.positions.size() - mesh.positions.size());
    EXPECT_LT(welded.largest_move, 1e-5);
    EXPECT_EQ(welded.t_junctions, 0u);
    EXPECT_EQ(welded.vertex.size(), apart.positions.size());
    EXPECT_TRUE(inspect(welded.mesh).closed);
  }
  // Sides that are divided differently meet in T-junctions.
  EXPECT_GT(weld(joined(grid_square(1, 0, 2), moved(grid_square(1, 0, 3), {1, 0, 0}))).t_junctions, 0u);
  EXPECT_TRUE(inspect(weld(grid_block({-1, -1, -1}, {1, 1, 1}, 3)).mesh).closed);
}

TEST(SmokeMeshes, IslandsAreRemovedByTheirFacesAndArea) {
  const Mesh mesh =
      joined(joined(sphere(1), moved(tetrahedron(), {4, 0, 0})), moved(single_triangle(), {0, 7, 0}));
  const WithoutIslands few = remove_islands(mesh, {.faces = 4});
  EXPECT_EQ(few.islands, 1u);
  EXPECT_EQ(few.mesh.triangles.size(), 84u);
  EXPECT_EQ(remove_islands(mesh, {.area_fraction = 0.3}).islands, 2u);
  EXPECT_EQ(remove_islands(mesh, {.area = 3}).face.size(), 80u);
}

TEST(SmokeMeshes, NoCornerIsOutsideOfTheConvexHull) {
  std::mt19937 random(3);
  for (const Mesh& mesh : {cube(), torus(9, 7), sphere(1), soup(17, random),
                           grid_block({0, 0, 0}, {1, 2, 3}, 3), moved(tetrahedron(), {1e5, 1e5, 1e5})}) {
    const Mesh hull = convex_hull(mesh);
    EXPECT_TRUE(inspect(hull).closed);
    EXPECT_TRUE(Shape(hull).convex());
    const double size = scene_diagonal(mesh, mesh);
    for (const auto& [a, b, c] : hull.triangles) {
      const Vec3 &p = hull.positions[a], n = normalized(cross(hull.positions[b] - p, hull.positions[c] - p));
      for (const Vec3& q : mesh.positions) EXPECT_LE(dot(n, q - p), 1e-9 * size);
    }
  }
  EXPECT_THROW((void)convex_hull(square(1, 0)), Error);
}

TEST(SmokeMeshes, VolumesOfUnionsCountOnce) {
  EXPECT_NEAR(solid_volume(Sites(cube())).value, 8, 1e-9);
  EXPECT_NEAR(solid_volume(Sites(joined(cube(), flipped(cube(0.5))))).value, 7, 1e-7) << "a cavity";
  const Sites crossing(joined(cube(), moved(cube(), {0.9, 0.3, 0.2})));
  const BoundedNumber volume = solid_volume(crossing);
  EXPECT_LE(volume.lower, 16 - 1.1 * 1.7 * 1.8 + 1e-6);
  EXPECT_GE(volume.upper, 16 - 1.1 * 1.7 * 1.8 - 1e-6);
  EXPECT_LT(volume.upper - volume.lower, 1e-5);
  EXPECT_NEAR(solid_volume(Sites(moved(tetrahedron(), {1e3, 0, 0})), {.embedded = true}).value, 1.0 / 6,
              1e-7);
  EXPECT_THROW((void)solid_volume(Sites(square(1, 0))), Error);
}

TEST(SmokeMeshes, SelfIntersectionsAreThePairsOfFacesThatCross) {
  std::mt19937 random(8);
  const Mesh crossing = joined(cube(), moved(cube(), {0.9, 0.3, 0.2})), many = soup(61, random);
  for (const Mesh& mesh : {crossing, many}) {
    const Sites sites(mesh);
    std::vector<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (std::uint32_t g = f + 1; g < mesh.triangles.size(); ++g) {
        const auto corners = [&](std::uint32_t face) {
          const auto& [a, b, c] = mesh.triangles[face];
          return Corners{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
        };
        bool share = false;
        for (const std::uint32_t a : mesh.triangles[f])
          for (const std::uint32_t b : mesh.triangles[g]) share = share || a == b;
        if (!share && oracle::intersect(corners(f), corners(g))) expected.push_back({f, g});
      }
    EXPECT_THAT(self_intersections(sites), ::testing::ElementsAreArray(expected));
    EXPECT_EQ(self_intersections(sites, self_intersection_budget(sites)).pairs.size(), expected.size());
    EXPECT_FALSE(self_intersections(sites, 0).all);
    EXPECT_EQ(is_embedded(sites), expected.empty());
  }
  EXPECT_TRUE(is_embedded(Sites(torus(9, 7))));
  // Neighbours that fold onto each other.
  EXPECT_FALSE(is_embedded(Sites({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.2, 0}},
                                  .triangles = {{0, 1, 2}, {0, 1, 3}},
                                  .corner_uvs = {}})));
}

// Sites after random edits against those of the edited mesh: edges, orientation, distances.
TEST(SmokeMeshes, EditedSitesAreThoseOfTheEditedMesh) {
  Mesh mesh = torus(9, 7);
  mesh.corner_uvs.clear();
  Sites sites(mesh);
  std::mt19937 random(10);
  for (int step = 0; step < 5; ++step) {
    MeshEdit edit;
    const auto some_vertex = [&] { return static_cast<std::uint32_t>(random() % mesh.positions.size()); };
    for (std::uint32_t f = static_cast<std::uint32_t>(step); f < mesh.triangles.size(); f += 19)
      if (!is_removed(mesh.triangles[f])) edit.removed_faces.push_back(f);
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
    edit.added_vertices = random_points({{-3, -3, -1}, {3, 3, 1}}, 3, static_cast<unsigned>(step));
    edit.added_faces = {{vertices, vertices + 1, vertices + 2}, {0, 1, vertices}, {vertices + 2, 3, 4}};
    edit.moved_vertices.push_back({.vertex = some_vertex(), .position = {0.3, 0.1, 1.5}});
    sites.edit(edit);
    apply(mesh, edit);
    const Sites expected(mesh);
    EXPECT_TRUE(std::ranges::equal(sites.edges(), expected.edges()));
    EXPECT_EQ(sites.orientable(), expected.orientable());
    const std::vector<Vec3> points = random_points(around(mesh), 67, 5);
    const std::vector<ClosestPoint> found = closest_points(sites, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(found[i].distance, oracle::brute_force(mesh, points[i]), 2e-5);
  }
}

TEST(SmokeMeshes, NormalsOfCornersAreSmoothUpToTheCrease) {
  const MeshAttribute smooth = smooth_normals(sphere(1)), flat = smooth_normals(cube(), 30);
  for (std::size_t f = 0; f < sphere(1).triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const n = &smooth.values[3 * (*smooth.rows)[f][k]];
      EXPECT_GT(dot(Vec3{n[0], n[1], n[2]}, sphere(1).positions[sphere(1).triangles[f][k]]), 0.99);
    }
  const float* const up = &flat.values[3 * (*flat.rows)[2][0]];
  EXPECT_EQ(up[2], 1);
}

}  // namespace
}  // namespace sdm::test
