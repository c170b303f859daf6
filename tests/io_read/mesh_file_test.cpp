// What files say about their meshes: names of faces, and their own vertices.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/io.h>

#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;

MeshFile file_of(const std::string& name, std::string_view contents) {
  return read_mesh_file(write_file(name, contents), {.vertices = true});
}

/// The name of each face, of one kind.
std::vector<std::string> names_of(const MeshFile& file, std::string_view kind) {
  for (const FaceNames& names : file.names)
    if (names.kind == kind) {
      std::vector<std::string> result;
      for (const std::uint32_t name : names.of_face)
        result.push_back(name == kNone ? "" : names.names.at(name));
      EXPECT_EQ(result.size(), file.mesh.triangles.size());
      return result;
    }
  return {};
}

// A quad, a triangle, a polygon too small to be one, and a triangle; names without faces between them.
constexpr std::string_view kNamed =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\n"
    "f 1 2 3\no  a part \ng left right\nusemtl red\nf 1 2 3 4\n"
    "usemtl unused\nusemtl blue # paint\ng\nf 1 2\nf 3 4 5\nusemtl red\nf 4 5 1\no end\n";

TEST(FaceNames, OfObjHoldUntilTheNextOfTheirKind) {
  const MeshFile file = file_of("a.obj", kNamed);
  ASSERT_EQ(file.names.size(), 3u);
  EXPECT_THAT(names_of(file, "object"), ElementsAre("", "a part", "a part", "a part", "a part"));
  EXPECT_THAT(names_of(file, "group"), ElementsAre("", "left right", "left right", "", ""));
  EXPECT_THAT(names_of(file, "material"), ElementsAre("", "red", "red", "blue", "red"));
  EXPECT_EQ(read_as("a.obj", kNamed).triangles, file.mesh.triangles);
}

TEST(FaceNames, OfSolidsOfStlAnd3dsObjects) {
  const std::string solid =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  const MeshFile stl = file_of(
      "a.stl", "solid one part\n" + solid + "endsolid one part\nsolid two\n" + solid + solid + "endsolid\n");
  EXPECT_THAT(names_of(stl, "object"), ElementsAre("one part", "two", "two"));
  EXPECT_EQ(file_of("a.3ds", tds(tetrahedron())).names.size(), 1u);
  EXPECT_TRUE(file_of("a.ply", ply_text(tetrahedron())).names.empty());
}

TEST(FaceNames, OfGltfMeshesAndMaterials) {
  const auto replace = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << text;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  const Mesh mesh = tetrahedron();
  const std::string uri = R"(,"uri":"data:;base64,)" + base64(gltf_buffer(mesh)) + "\"";
  const std::string json = gltf_json(mesh, R"([{"mesh":0,"name":"node"}])", uri);
  EXPECT_THAT(names_of(file_of("a.gltf", json), "object"), ElementsAre("node", "node", "node", "node"));
  const std::string named =
      replace(json, R"("primitives":[{)", R"("name":"body","primitives":[{"material":1,)");
  EXPECT_EQ(names_of(file_of("a.gltf", named), "object")[0], "body");
  EXPECT_EQ(names_of(file_of("a.gltf", named), "material")[0], "material 1") << "a material that is missing";
  const std::string with_materials =
      replace(named, R"("meshes")", R"("materials":[{},{"name":"steel"}],"meshes")");
  EXPECT_EQ(names_of(file_of("a.gltf", with_materials), "material")[0], "steel");
  for (const char* strange : {R"("x")", "-1", "99999999999999999999", "1.5", "null"})
    EXPECT_EQ(file_of("a.gltf", replace(named, R"("material":1)", std::string(R"("material":)") + strange))
                  .mesh.triangles.size(),
              4u);
}

TEST(FileVertices, AreThoseOfTheFileInItsOrder) {
  const MeshFile file = file_of(
      "a.obj",
      "v 5 5 5\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 0 1 0\nv nan 0 0\nf 2 3 4\nf 5 4 6\nf 2 3 4 6\n");
  ASSERT_TRUE(file.vertices);
  const FileVertices& v = *file.vertices;
  EXPECT_EQ(v.positions.size(), 7u);
  EXPECT_THAT(v.mesh_vertex, ElementsAre(kNone, 0, 1, 2, 0, 3, kNone));
  EXPECT_THAT(v.corners, ElementsAre(1, 2, 3, 4, 3, 5, 1, 2, 3, 5));
  EXPECT_THAT(v.ends, ElementsAre(3, 6, 10));
  const MeshFile stl = file_of("a.stl", stl_binary(cube()));
  EXPECT_EQ(stl.vertices->positions.size(), 36u);
  EXPECT_EQ(stl.mesh.positions.size(), 8u);
  EXPECT_FALSE(read_mesh_file(write_file("a.obj", kNamed)).vertices);
}

}  // namespace
}  // namespace sdm::test
