// Convex hulls of meshes.
#include <gmock/gmock.h>
#include <sdm/sdm.h>

#include <random>
#include <set>

#include "geometry/predicates.h"
#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// Closed, convex, around all corners, and with corners for vertices: all exactly.
void expect_hull(const Mesh& hull, const Mesh& mesh) {
  EXPECT_TRUE(Shape(hull).convex());
  std::set<Vec3> corners;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) corners.insert(mesh.positions[vertex]);
  for (const Vec3& p : hull.positions) EXPECT_TRUE(corners.contains(p));
  std::size_t outside = 0;
  for (const auto& [a, b, c] : hull.triangles)
    for (const Vec3& p : corners)
      outside += orientation(hull.positions[a], hull.positions[b], hull.positions[c], p) > 0;
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(hull.triangles.size() + 4, 2 * hull.positions.size());
}

TEST(ConvexHull, IsAroundAnyMesh) {
  std::mt19937 random(4);
  for (const Mesh& mesh :
       {torus(16, 8), soup(300, random), degenerate_soup(100, 2), height_field(12), needles(1e-6),
        band(12, true), wedge(1e-4), joined(cube(), moved(sphere(2), {3, 0.1, 0}))})
    expect_hull(convex_hull(mesh), mesh);
}

TEST(ConvexHull, OfManyPointsInPlanesIsExact) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> place(0, 6);
  Mesh grid;
  for (int i = 0; i < 600; ++i) {
    grid.positions.push_back({0.1 * place(random), 0.1 * place(random), 0.1 * place(random)});
    if (i % 3 == 2)
      grid.triangles.push_back({static_cast<std::uint32_t>(i - 2), static_cast<std::uint32_t>(i - 1),
                                static_cast<std::uint32_t>(i)});
  }
  expect_hull(convex_hull(grid), grid);
}

TEST(ConvexHull, OfAHullIsTheHull) {
  for (const Mesh& mesh : {tetrahedron(), cube(), sphere(3)}) {
    const Mesh hull = convex_hull(mesh);
    expect_hull(hull, mesh);
    EXPECT_EQ(hull.positions, mesh.positions);
    EXPECT_EQ(convex_hull(hull).positions, hull.positions);
    EXPECT_NEAR(solid_volume(Sites(hull)).value, solid_volume(Sites(mesh)).value, 1e-12);
  }
}

TEST(ConvexHull, OfNothingSolidIsRefused) {
  for (const Mesh& mesh : {square(2, 0.5), single_triangle()})
    EXPECT_THAT(error_of([&] { (void)convex_hull(mesh); }), testing::HasSubstr("in one plane"));
  Mesh line;
  line.positions = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}};
  line.triangles = {{0, 1, 2}};
  EXPECT_THROW((void)convex_hull(line), Error) << "no face has an area";
  EXPECT_THROW((void)convex_hull(Mesh{}), Error);
}

}  // namespace
}  // namespace sdm::test
