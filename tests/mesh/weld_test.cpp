#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/sites.h>

#include <cmath>
#include <random>

#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm {
namespace {

// A blade with this angle at its edge.
Mesh blade(double angle) {
  Mesh mesh;
  const double height = std::sin(angle);
  for (const double x : {0.0, 1.0})
    for (const Vec3& p : {Vec3{x, 0, 0}, {x, std::cos(angle), height}, {x, 1, 0}})
      mesh.positions.push_back(p);
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 2, 5}, {0, 5, 3}, {2, 1, 4}, {2, 4, 5}, {1, 0, 3}, {1, 3, 4}};
  return mesh;
}

bool collapses_a_face(const Mesh& before, const Mesh& after) {
  const auto distinct = [](const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; };
  for (std::size_t f = 0; f < before.triangles.size(); ++f)
    if (distinct(before.triangles[f]) && !distinct(after.triangles[f])) return true;
  return false;
}

TEST(Weld, ClosesWhatIsOffByRounding) {
  for (const auto& [whole, name] : {std::pair(test::cube(), "cube"),
                                    {test::sphere(4), "sphere"},
                                    {test::torus(40, 20), "torus"},
                                    {blade(0.03), "blade"}}) {
    constexpr double kError = 1e-6;
    const Mesh apart = test::taken_apart(whole, kError);
    ASSERT_FALSE(inspect(apart).closed) << name;
    const Welded welded = weld(apart);
    const MeshInfo info = inspect(welded.mesh);
    EXPECT_EQ(info.closed, inspect(whole).closed) << name;
    EXPECT_EQ(info.vertices - info.unused_vertices, whole.positions.size()) << name;
    EXPECT_EQ(welded.boundary_edges, info.boundary_edges) << name;
    EXPECT_EQ(welded.joined_vertices, apart.positions.size() - whole.positions.size()) << name;
    EXPECT_LE(welded.tolerance, 2 * std::sqrt(3) * kError) << name;
    EXPECT_LE(welded.largest_move, 2 * std::sqrt(3) * kError) << name;
    EXPECT_GT(welded.largest_move, 0) << name;
    EXPECT_EQ(welded.t_junctions, 0u) << name;
  }
}

TEST(Weld, VerticesGoWhereTheirFacesGo) {
  const Mesh apart = test::taken_apart(test::sphere(3), 1e-5);
  const Welded welded = weld(apart);
  ASSERT_EQ(welded.vertex.size(), apart.positions.size());
  double largest = 0;
  for (std::size_t v = 0; v < apart.positions.size(); ++v) {
    EXPECT_EQ(welded.mesh.positions[v], apart.positions[welded.vertex[v]]);
    largest = std::max(largest, norm(welded.mesh.positions[v] - apart.positions[v]));
  }
  EXPECT_EQ(largest, welded.largest_move);
  for (std::size_t f = 0; f < apart.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(welded.mesh.triangles[f][k], welded.vertex[apart.triangles[f][k]]);
}

TEST(Weld, DoesNotJoinTheSidesOfASheet) {
  const Mesh sheet = test::single_triangle();
  const Mesh both = test::taken_apart(test::joined(sheet, test::flipped(sheet)), 1e-6);
  EXPECT_EQ(weld(both).joined_vertices, 0u);
}

TEST(Weld, DoesNotJoinTheSidesOfAThinWall) {
  // Two skins whose rims are closer than the tolerance, of one sheet without its narrow side.
  const double thickness = 0.05;
  const Mesh skins = test::joined(test::square(1, thickness), test::flipped(test::square(1, 0)));
  for (const double tolerance : {0.06, 0.2}) EXPECT_EQ(weld(skins, {tolerance}).joined_vertices, 0u);

  // A closed plate that is thinner than the tolerance, with all faces apart: still a plate.
  const Mesh plate = test::box({0.5, 0.5, 0.5 * thickness});
  const Welded welded = weld(test::taken_apart(plate, 1e-6), {2 * thickness});
  EXPECT_TRUE(inspect(welded.mesh).closed);
  EXPECT_NEAR(solid_volume(Sites(welded.mesh)).upper, thickness, 1e-5);
}

TEST(Weld, OpenMeshesStayOpen) {
  const Mesh sheet = test::height_field(20);
  const Welded welded = weld(sheet);
  EXPECT_EQ(welded.joined_vertices, 0u);
  EXPECT_EQ(welded.tolerance, 0);
  EXPECT_EQ(welded.largest_move, 0);
  EXPECT_EQ(welded.mesh.triangles, sheet.triangles);
  EXPECT_EQ(welded.boundary_edges, inspect(sheet).boundary_edges);
  // With all faces apart, only the inner edges close.
  const Welded apart = weld(test::taken_apart(sheet, 1e-6));
  EXPECT_EQ(apart.boundary_edges, welded.boundary_edges);
}

TEST(Weld, AGapWiderThanTheToleranceStays) {
  const Mesh apart = test::taken_apart(test::cube(), 1e-3);
  EXPECT_EQ(weld(apart, {1e-6}).joined_vertices, 0u);
  EXPECT_TRUE(inspect(weld(apart, {1e-2}).mesh).closed);
}

TEST(Weld, CountsTJunctions) {
  // Two rectangles side by side, one of which has a vertex in the middle of the common edge.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},  {1, 0, 0},
                    {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 0.5, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 8}, {5, 6, 8}, {6, 7, 8}};
  const Welded welded = weld(mesh);
  EXPECT_EQ(welded.t_junctions, 1u);
  EXPECT_EQ(welded.boundary_edges, 9u);
}

TEST(Weld, NeverCollapsesAFace) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Mesh mesh = test::soup(40, random);
    const double size = norm(bounds(mesh).upper - bounds(mesh).lower);
    const double tolerance = size * std::pow(10, std::uniform_real_distribution(-3.0, 0.0)(random));
    const Welded welded = weld(mesh, {tolerance});
    EXPECT_FALSE(collapses_a_face(mesh, welded.mesh)) << trial;
    EXPECT_LE(welded.tolerance, tolerance);
  }
}

TEST(Weld, ManyEdgesInOnePlace) {
  // Each pair of wedges could close by any of the others' faces.
  Mesh stack;
  for (int i = 0; i < 10; ++i) stack = test::joined(stack, test::cube());
  const Welded welded = weld(test::taken_apart(stack, 1e-6));
  EXPECT_EQ(welded.boundary_edges, 0u);
}

TEST(Weld, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Mesh apart = test::taken_apart(test::torus(30, 20), 1e-5);
  const Welded all = weld(apart);
  const ThreadLimit one(1);
  const Welded single = weld(apart);
  EXPECT_EQ(all.mesh.triangles, single.mesh.triangles);
  EXPECT_EQ(all.mesh.positions, single.mesh.positions);
}

TEST(Weld, RefusesTolerances) {
  for (const double tolerance : {0.0, -1.0, std::nan("")})
    EXPECT_EQ(test::error_of([&] { (void)weld(test::cube(), {tolerance}); }),
              "tolerance is " + text_of(tolerance) + ": it must be a number greater than 0");
}

}  // namespace
}  // namespace sdm
