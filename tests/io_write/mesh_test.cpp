// Meshes as files: what write_mesh() writes, read_mesh() returns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <cmath>

#include "support/error_of.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

/// The corners in turn: where they are, and their texture coordinates.
std::vector<std::pair<Vec3, Vec2>> corners_with_uvs(const Mesh& mesh) {
  std::vector<std::pair<Vec3, Vec2>> corners;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k)
      corners.push_back(
          {mesh.positions[mesh.triangles[f][k]], mesh.corner_uvs.empty() ? Vec2{} : mesh.corner_uvs[f][k]});
  return corners;
}

TEST(WriteMesh, ReadsBackBitIdentical) {
  const TemporaryFolder folder;
  Mesh mesh = torus(24, 16);
  for (Vec3& p : mesh.positions) p = 0.1 * p;  // more digits than a float has
  for (auto& uvs : mesh.corner_uvs)
    for (Vec2& uv : uvs) uv[0] /= 3;
  Mesh plain = mesh;
  plain.corner_uvs.clear();
  for (const Mesh& written : {mesh, plain})
    for (const char* name : {"mesh.ply", "mesh.obj", "MESH.PLY"}) {
      write_mesh(folder / name, written);
      const Mesh read = read_mesh(folder / name);
      EXPECT_EQ(corners_with_uvs(read), corners_with_uvs(written)) << name;
      EXPECT_EQ(read.corner_uvs.size(), written.corner_uvs.size()) << name;
      EXPECT_FALSE(is_written_in_single_precision(folder / name));
    }
}

TEST(WriteMesh, RoundsToSinglePrecisionWhereTheFormatDoes) {
  const TemporaryFolder folder;
  Mesh mesh = torus(24, 16);
  for (Vec3& p : mesh.positions) p = 0.1 * p;
  for (const char* name : {"mesh.stl", "mesh.glb"}) {
    ASSERT_TRUE(is_written_in_single_precision(folder / name));
    write_mesh(folder / name, mesh);
    const Mesh read = read_mesh(folder / name);
    ASSERT_EQ(read.triangles.size(), mesh.triangles.size()) << name;
    EXPECT_TRUE(inspect(read).closed) << name;
    const bool has_uvs = !read.corner_uvs.empty();
    EXPECT_EQ(has_uvs, std::string(name) == "mesh.glb");
    const auto found = corners_with_uvs(read), wanted = corners_with_uvs(mesh);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        ASSERT_EQ(found[i].first[k], static_cast<float>(wanted[i].first[k])) << name;
      for (int k = 0; k < 2 && has_uvs; ++k)
        ASSERT_NEAR(found[i].second[k], wanted[i].second[k], 1e-7) << name;
    }
  }
}

TEST(WriteMesh, RefusesOtherExtensionsAndFolders) {
  const TemporaryFolder folder;
  for (const char* name : {"mesh.xyz", "mesh", "mesh.gltf"})
    EXPECT_THAT(error_of([&] {
                  write_mesh(folder / name, cube());
                  return 0;
                }),
                ::testing::HasSubstr(".ply, .obj, .stl or .glb"));
  EXPECT_TRUE(folder.empty());
  EXPECT_THROW(write_mesh(folder.path() / "no" / "mesh.obj", cube()), Error);
}

}  // namespace
}  // namespace sdm::test
