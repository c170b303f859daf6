// What files say about their meshes: names of faces, and their own vertices.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

// A mesh keeps its texture coordinates if every corner has some that are valid; otherwise a note says why
// not.
TEST(FileNotes, SayWhyTextureCoordinatesAreLeftOut) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
  const std::pair<const char*, const char*> faulty[] = {
      {"f 1/9 2/9 3/9\n", "in line 5, a face refers to number 9 of 0"},
      {"vt 0 0\nvt 1 0\nf 1/1 2/2 3/3\n", "in line 7, a face refers to number 3 of 2"},
      {"vt 0 0\nf 1/1 2/1 3/1\nf 2/1 4/0 3/1\n", "in line 7, a face refers to number 0 of 1"},
      {"vt 0 0\nf 1/-2 2/1 3/1\n", "in line 6, a face refers to number -2 of 1"},
      {"vt 0 0\nf 1/1 2/1 3/99999999999\n", "in line 6, a face refers to number 99999999999 of 1"},
      {"vt 0 0\nf 1/1 2/1 3/1\nf 2 4 3\n", "face 1 has none at a corner"},
      {"vt 0 0\nf 1/1 2/1 3\n", "face 0 has none at a corner"},
      {"vt 0 0\nvt nan 0\nf 1/1 2/1 3/1\nf 2/1 4/2 3/1\n", "face 1 has some that are infinite or NaN"}};
  for (const auto& [text, note] : faulty) {
    const MeshFile file = file_of("a.obj", start + text);
    EXPECT_EQ(file.mesh.triangles[0], (Triangle{0, 1, 2})) << text;
    EXPECT_THAT(file.mesh.corner_uvs, IsEmpty()) << text;
    EXPECT_THAT(file.notes, ElementsAre(HasSubstr(note))) << text;
    EXPECT_THAT(file.notes, ElementsAre(HasSubstr("the texture coordinates are left out"))) << text;
  }
  for (const char* good : {"vt 0 0\nf 1/1 2/1 3/1\n", "vt 0 0\nf 1 2 3\n", "f 1//9 2//9 3//9\n",
                           "f 1/1 2/1 3/1\nvt 0 0\n", "f 1 2 3\n"})
    EXPECT_THAT(file_of("a.obj", start + good).notes, IsEmpty()) << good;
}

TEST(FileNotes, OfPlyFacesWithoutTextureCoordinates) {
  const std::string contents =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n3 0 2 1 0\n";
  EXPECT_THAT(file_of("a.ply", contents).notes, ElementsAre(HasSubstr("some faces have none")));
}

TEST(FileNotes, NameWhatFollowsTheDeclaredRows) {
  const Mesh mesh = tetrahedron();
  EXPECT_THAT(file_of("a.off", off(mesh) + "3 0 1 2\n").notes,
              ElementsAre("what follows the 4 declared faces, from line 11 on, is left out"));
  for (const std::string& ply : {ply_text(mesh), ply_binary(mesh, std::endian::big)}) {
    EXPECT_THAT(file_of("a.ply", ply + "3 0 1 2\n").notes,
                ElementsAre("what follows the declared rows is left out"));
    EXPECT_THAT(file_of("a.ply", ply + "\n").notes, IsEmpty());
  }
  EXPECT_THAT(file_of("a.off", off(mesh) + "\n# the end\n").notes, IsEmpty());
}

TEST(FileNotes, NameFreeFormSurfaces) {
  const MeshFile file = file_of("a.obj", std::string(kNamed) + "surf 0 1 0 1 1 2 3 4\nend\n");
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("1 free-form surfaces (statement surf) are left out")));
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

// The vectors are those of xxHash.
TEST(FileXxh3, IsThatOfTheBytes) {
  EXPECT_EQ(file_xxh3(write_file("empty", "")), "2d06800538d394c2");
  EXPECT_EQ(file_xxh3(write_file("abc", "abc")), "78af5f94892f3950");
  std::string text(kNamed);  // longer than what is read at once
  for (int i = 0; i < 100'000; ++i) text += "# 0123456789\n";
  const auto file = write_file("long.obj", text);
  const std::string whole = read_mesh_file(file).xxh3;
  EXPECT_EQ(whole, file_xxh3(file));
  text.back() = ' ';
  EXPECT_NE(whole, file_xxh3(write_file("long.obj", text)));
  try {
    (void)file_xxh3("nowhere.obj");
    ADD_FAILURE() << "there is no such file";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("nowhere.obj: there is no such file"));
  }
}

}  // namespace
}  // namespace sdm::test
