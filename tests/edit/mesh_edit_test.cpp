#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh_edit.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <functional>

#include "support/shapes.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;

TEST(MeshEdit, KeepsTheNumbersOfAllThatStays) {
  Mesh mesh = test::cube();
  const Mesh before = mesh;
  const auto n = static_cast<std::uint32_t>(before.positions.size());
  apply(mesh, {.removed_faces = {3},
               .reconnected_faces = {{5, {n, before.triangles[5][1], before.triangles[5][2]}}},
               .moved_vertices = {{0, {-2, -2, -2}}},
               .added_vertices = {{3, 0, 0}, {4, 0, 0}},
               .added_faces = {{0, 1, n + 1}}});
  ASSERT_EQ(mesh.triangles.size(), before.triangles.size() + 1);
  ASSERT_EQ(mesh.positions.size(), before.positions.size() + 2);
  for (std::size_t f = 0; f < before.triangles.size(); ++f)
    if (f != 3 && f != 5) {
      EXPECT_EQ(mesh.triangles[f], before.triangles[f]);
    }
  EXPECT_TRUE(is_removed(mesh.triangles[3]));
  EXPECT_EQ(mesh.triangles[3][0], before.triangles[3][0]);
  EXPECT_EQ(mesh.triangles[5][0], n);
  EXPECT_EQ(mesh.triangles.back(), (Triangle{0, 1, n + 1}));
  EXPECT_EQ(mesh.positions[0], (Vec3{-2, -2, -2}));
  EXPECT_EQ(mesh.positions[1], before.positions[1]);
  EXPECT_EQ(mesh.positions[n + 1], (Vec3{4, 0, 0}));
}

TEST(MeshEdit, RemovedFacesCountNowhere) {
  Mesh mesh = test::joined(test::cube(), test::moved(test::tetrahedron(), {100, 0, 0}));
  const Box cube = bounds(test::cube());
  const auto first = static_cast<std::uint32_t>(test::cube().triangles.size());
  apply(mesh, {.removed_faces = {first, first + 1, first + 2, first + 3}});
  EXPECT_EQ(bounds(mesh).upper, cube.upper);
  const MeshInfo info = inspect(mesh), alone = inspect(test::cube());
  EXPECT_EQ(info.components, 1u);
  EXPECT_EQ(info.edges, alone.edges);
  EXPECT_EQ(info.unused_vertices, 4u);
  EXPECT_EQ(info.area, alone.area);
  EXPECT_TRUE(info.closed && info.oriented && info.manifold);
}

// A range of faces of which none is left had extended the bounds to infinity.
TEST(MeshEdit, BoundsIgnoreLongRunsOfRemovedFaces) {
  Mesh mesh = test::joined(test::sphere(6), test::moved(test::cube(), {5, 0, 0}));
  const auto faces = static_cast<std::uint32_t>(test::sphere(6).triangles.size());
  ASSERT_GT(faces, 50000u);
  MeshEdit edit;
  for (std::uint32_t f = 0; f < faces; ++f) edit.removed_faces.push_back(f);
  apply(mesh, edit);
  EXPECT_EQ(bounds(mesh).lower, (Vec3{4, -1, -1}));
  EXPECT_EQ(bounds(mesh).upper, (Vec3{6, 1, 1}));
}

TEST(MeshEdit, RefusesWhatIsInvalidAndChangesNothing) {
  const Mesh mesh = test::cube();
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  Mesh holed = mesh;
  apply(holed, {.removed_faces = {0}});
  std::vector<std::uint32_t> all(mesh.triangles.size());
  for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = f;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const Mesh& mesh;
    MeshEdit edit;
    const char* message;
  } cases[] = {
      {mesh, {.removed_faces = {12}}, "removes face 12, but there are 12 faces"},
      {mesh, {.removed_faces = {4, 4}}, "changes face 4, which it changes twice"},
      {mesh, {.removed_faces = {4}, .reconnected_faces = {{4, {0, 1, 2}}}}, "changes face 4, which it"},
      {holed, {.removed_faces = {0}}, "removes face 0, which has been removed before"},
      {holed, {.reconnected_faces = {{0, {0, 1, 2}}}}, "reconnects face 0, which has been removed before"},
      {mesh, {.added_faces = {{0, 1, n}}}, "adds face 12, whose corner 8 is none of the 8 vertices"},
      {mesh, {.added_faces = {{1, 1, 1}}}, "adds face 12, whose corners are all the same vertex"},
      {mesh, {.moved_vertices = {{n, {}}}}, "moves vertex 8, but there are 8 vertices"},
      {mesh, {.moved_vertices = {{0, {nan, 0, 0}}}}, "NaN"},
      {mesh, {.added_vertices = {{0, 0, 1e38}}}, "1e37"},
      {mesh, {.removed_faces = all}, "none has positive area"},
      {mesh, {.added_faces = {{0, 1, 2}}, .added_corner_uvs = {{}}}, "texture coordinates for 1 of 1"},
  };
  for (const auto& [given, edit, message] : cases) {
    SCOPED_TRACE(message);
    Mesh edited = given;
    Sites sites(given);
    Surface surface(given, {.resolution = 64});
    for (const std::function<void()>& attempt : std::initializer_list<std::function<void()>>{
             [&] { apply(edited, edit); }, [&] { sites.edit(edit); }, [&] { surface.edit(edit); }})
      EXPECT_THAT(attempt, ::testing::ThrowsMessage<Error>(HasSubstr(message)));
    EXPECT_EQ(edited.triangles, given.triangles);
    EXPECT_EQ(edited.positions, given.positions);
    EXPECT_EQ(sites.mesh().triangles, given.triangles);
    EXPECT_EQ(surface.mesh().positions, given.positions);
  }
}

TEST(MeshEdit, CompletesTextureCoordinates) {
  Mesh mesh = test::torus(8, 8);
  const std::size_t faces = mesh.triangles.size();
  apply(mesh, {.added_faces = {{0, 1, 2}}});
  apply(mesh, {.added_faces = {{1, 2, 3}}, .added_corner_uvs = {{{{0.5, 0.25}, {1, 0}, {0, 1}}}}});
  ASSERT_EQ(mesh.corner_uvs.size(), faces + 2);
  EXPECT_EQ(mesh.corner_uvs[faces][1], (Vec2{0, 0}));
  EXPECT_EQ(mesh.corner_uvs[faces + 1][0], (Vec2{0.5, 0.25}));
}

}  // namespace
}  // namespace sdm
