// Materials and textures that mesh files refer to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include <fstream>
#include <string>

#include "io_read/gltf_store.h"
#include "io_read/writers.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

MeshFile with_materials(const std::filesystem::path& file) {
  return read_mesh_file(file, {.attributes = true});
}
std::string text_of(const TextureFile& texture) {
  return {texture.bytes.begin(), texture.bytes.end()};
}

struct ObjWithMaterials : ::testing::Test {
  static constexpr const char* kUnknown = "no MTL file has the material unknown, so faces of it are white";
  TemporaryFolder folder;

  void write(const std::string& name, const std::string& contents) const {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    std::ofstream(folder.path() / name, std::ios::binary) << contents;
  }
  [[nodiscard]] MeshFile read(const std::string& library) const {
    write("a b.mtl", library);
    write("a.obj",
          "mtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl wood\nf 1 2 3 4\n"
          "usemtl unknown\nf 2 3 4\nusemtl steel\nf 3 4 1\n");
    return with_materials(folder.path() / "a.obj");
  }
};

TEST_F(ObjWithMaterials, AreThoseOfItsLibrary) {
  write("maps/my wood.png", "picture");
  write("0001", "another");
  const MeshFile file = read(
      "# made by hand\nnewmtl wood\nKd 0.2 0.2 0.2\nmap_Kd -s 2 3 1 -o 0.5 -clamp on -mm 0 1 maps\\my "
      "wood.png\n"
      "norm -bm 0.5 0001\nmap_Ke maps/my wood.png\nnewmtl steel\nKd 1 0.5 0\nTr 0.25\nPm 1\nPr 0.3\n"
      "bump heights.png\nKs 1 1 1\nillum 2\n");
  ASSERT_EQ(file.materials.size(), 2u);
  const Material& wood = file.materials[0];
  EXPECT_EQ(wood.name, "wood");
  EXPECT_THAT(wood.base_color, ElementsAre(1, 1, 1, 1));  // in place of Kd: the picture
  EXPECT_THAT(wood.base_color_texture.place[0], ElementsAre(2, 0, 0.5));
  EXPECT_THAT(wood.base_color_texture.place[1], ElementsAre(0, 3, 0));
  EXPECT_EQ(wood.base_color_texture.wrap[1], TextureWrap::clamp);
  EXPECT_EQ(wood.emissive_texture.texture, wood.base_color_texture.texture);  // read once
  ASSERT_EQ(file.textures.size(), 2u);
  EXPECT_EQ(file.textures[0].name, "maps/my wood.png");
  EXPECT_EQ(text_of(file.textures[0]), "picture");
  EXPECT_EQ(text_of(file.textures[wood.normal_texture.texture]), "another");
  const Material& steel = file.materials[1];
  EXPECT_FLOAT_EQ(steel.base_color[0], 1);
  EXPECT_NEAR(steel.base_color[1], 0.21404114f, 1e-6f);
  EXPECT_FLOAT_EQ(steel.base_color[3], 0.75f);
  EXPECT_EQ(steel.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(wood.alpha_mode, AlphaMode::opaque);
  EXPECT_FLOAT_EQ(steel.metallic, 1);
  EXPECT_FLOAT_EQ(steel.roughness, 0.3f);
  EXPECT_THAT(file.face_materials, ElementsAre(kNone, 0, 0, kNone, 1));
  EXPECT_THAT(file.notes,
              ElementsAre(HasSubstr("Kd of the material wood is left out: the picture of map_Kd"),
                          HasSubstr("bump of the material steel is left out"), kUnknown,
                          "textures of wood are left out on 2 faces without texture coordinates"));
}

// Regression: these left materials or faces without their colours, without a word.
TEST_F(ObjWithMaterials, ALineMayNameSeveralLibraries) {
  write("a.mtl", "newmtl m\nKd 0 1 0\n");
  write("b.mtl", "newmtl n\nKd 1 0 0\n");
  const auto read_line = [&](const std::string& line) {
    write("g.obj", "mtllib " + line + "\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\nusemtl n\nf 1 3 2\n");
    return with_materials(folder.path() / "g.obj");
  };
  for (const char* line : {"a.mtl b.mtl", "a.mtl\tb.mtl", "b.mtl .\\a.mtl a.mtl"}) {
    const MeshFile file = read_line(line);
    ASSERT_EQ(file.materials.size(), 2u) << line;
    const Material& green = file.materials[file.face_materials[0]];
    EXPECT_THAT(green.base_color, ElementsAre(0, 1, 0, 1)) << line;
    EXPECT_THAT(file.materials[file.face_materials[1]].base_color, ElementsAre(1, 0, 0, 1)) << line;
    EXPECT_THAT(file.notes, IsEmpty());
  }
  EXPECT_THAT(read_line("a.mtl gone.mtl").notes,
              ElementsAre(HasSubstr("the materials of gone.mtl are left out")));
  EXPECT_THAT(read_line("a.mtl").notes,
              ElementsAre("no MTL file has the material n, so faces of it are white"));
}

TEST_F(ObjWithMaterials, PicturesOfOpacityAndPicturesInPlaceOfColoursAreNoted) {
  write("t.png", "picture");
  const auto notes = [&](const std::string& library) {
    write("h.mtl", "newmtl m\n" + library);
    write("h.obj",
          "mtllib h.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n");
    return with_materials(folder.path() / "h.obj").notes;
  };
  const char* const kReplaced = "Kd of the material m is left out: the picture of map_Kd replaces it";
  EXPECT_THAT(notes("Kd 1 0 0\nmap_d t.png\n"),
              ElementsAre(HasSubstr("map_d of the material m is left out: opacity")));
  EXPECT_THAT(notes("Kd 0.5 0.5 0.5\nmap_Kd t.png\n"), ElementsAre(kReplaced));
  EXPECT_THAT(notes("map_Kd t.png\nKd 0.5 0.5 0.5\n"), ElementsAre(kReplaced));
  EXPECT_THAT(notes("Kd 1 1 1\nmap_Kd t.png\n"), IsEmpty());
  EXPECT_THAT(notes("map_Pr t.png\n"), ElementsAre(HasSubstr("map_Pr of the material m is left out")));
  // Regression: one note named the first material only.
  EXPECT_THAT(notes("Kd 1 0 0\nmap_Kd t.png\nnewmtl n\nmap_Kd t.png\nKd 0 0 0\n"),
              ElementsAre("Kd of the materials m, n is left out: the picture of map_Kd replaces it"));
  EXPECT_THAT(notes("bump t.png\nnewmtl n\nbump t.png\nnewmtl o\nbump t.png\nnewmtl p\nbump t.png\n"),
              ElementsAre(HasSubstr("bump of the materials m, n, o and 1 more is left out")));
}

TEST_F(ObjWithMaterials, LibrariesAndPicturesAreReadOnceWhateverTheirNames) {
  write("p.png", "picture");
  write("c.mtl", "newmtl wood\nmap_Kd p.png\nmap_Ke ./p.png\n");
  write("c.obj", "mtllib c.mtl\nmtllib ./c.mtl\nmtllib c.mtl ./c.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const MeshFile file = with_materials(folder.path() / "c.obj");
  EXPECT_EQ(file.materials.size(), 1u);
  EXPECT_EQ(file.textures.size(), 1u);
  EXPECT_THAT(file.notes, IsEmpty());
}

TEST_F(ObjWithMaterials, AStatementThatCannotBeReadLeavesTheOthers) {
  const MeshFile file =
      read("newmtl wood\nd -halo 0.5\nKd spectral f.rfl\nPm nan\nPr 7\nnewmtl steel\nPm 1\n");
  ASSERT_EQ(file.materials.size(), 2u);
  EXPECT_EQ(file.materials[0].metallic, 0);
  EXPECT_EQ(file.materials[0].roughness, 1);
  EXPECT_EQ(file.materials[1].metallic, 1);
  EXPECT_FALSE(file.notes.empty());
}

TEST_F(ObjWithMaterials, TextureCoordinatesOfSomeFacesAreAnAttribute) {
  write("d.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n");
  const MeshFile file = with_materials(folder.path() / "d.obj");
  EXPECT_THAT(file.mesh.corner_uvs, IsEmpty());
  ASSERT_EQ(file.attributes.size(), 1u);
  const MeshAttribute& uvs = file.attributes[0];
  EXPECT_EQ(uvs.name, "uv0");
  EXPECT_EQ(uvs.values[2 * (*uvs.rows)[0][0]], 0.25f);
  EXPECT_THAT((*uvs.rows)[1], ElementsAre(kNone, kNone, kNone));
  EXPECT_THAT(file.notes, IsEmpty());
}

TEST_F(ObjWithMaterials, WhatCannotBeHadIsLeftOutWithANote) {
  const MeshFile file = read("newmtl wood\nKd 0 0 0\nmap_Kd none.png\nnewmtl steel\nmap_Kd ../outside.png\n");
  ASSERT_EQ(file.materials.size(), 2u);
  EXPECT_EQ(file.materials[0].base_color_texture.texture, kNone);
  EXPECT_THAT(file.materials[0].base_color, ElementsAre(0, 0, 0, 1));
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("none.png"),
                                      HasSubstr("the texture '../outside.png' is refused"), kUnknown));
  EXPECT_THAT(file.textures, IsEmpty());
  write("b.obj", "mtllib /etc/passwd\nmtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const MeshFile without = with_materials(folder.path() / "b.obj");
  EXPECT_THAT(without.notes, ElementsAre(HasSubstr("it is absolute"), HasSubstr("missing.mtl")));
  EXPECT_THAT(without.face_materials, IsEmpty());
  EXPECT_EQ(without.mesh.triangles.size(), 1u);
  write("c.mtl", "newmtl wood\nKd red\n");
  write("c.obj", "mtllib c.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  EXPECT_THAT(with_materials(folder.path() / "c.obj").notes,
              ElementsAre(HasSubstr("line 2: expected a number")));
}

// Once, one of them left all of the file out.
TEST_F(ObjWithMaterials, TextureCoordinatesThatDoNotExistLeaveTheOthers) {
  write("e.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 3/9 4/-7\n");
  const MeshFile file = with_materials(folder.path() / "e.obj");
  ASSERT_EQ(file.attributes.size(), 1u);
  EXPECT_EQ(file.attributes[0].name, "uv0");
  EXPECT_THAT((*file.attributes[0].rows)[1], ElementsAre(0, kNone, kNone));
  EXPECT_THAT(file.notes, ElementsAre("texture coordinates that do not exist are left out: in line 9, a face "
                                      "refers to number -7 of 3"));
  EXPECT_THAT(read_mesh_file(folder.path() / "e.obj").notes,
              ElementsAre(HasSubstr("the texture coordinates are left out: in line 9")));
}

// What a link, or an escaped name, leads to is looked at, not its text.
TEST_F(ObjWithMaterials, LinksOutOfTheFolderAreRefused) {
  const TemporaryFolder outside;
  std::ofstream(outside.path() / "secret.png") << "secret";
  write("inside.png", "picture");
  std::filesystem::create_symlink(outside.path() / "secret.png", folder.path() / "link.png");
  std::filesystem::create_symlink(outside.path(), folder.path() / "maps");
  std::filesystem::create_symlink("inside.png", folder.path() / "other.png");
  const MeshFile file = read(
      "newmtl wood\nmap_Kd link.png\nmap_Ke other.png\nnewmtl steel\nmap_Kd maps/secret.png\nmap_Ke "
      "%2e%2e/secret.png\n");
  ASSERT_EQ(file.textures.size(), 1u);
  EXPECT_EQ(text_of(file.textures[0]), "picture");
  EXPECT_EQ(file.materials[0].emissive_texture.texture, 0u);
  EXPECT_THAT(file.notes,
              ElementsAre(HasSubstr("'link.png' is refused"), HasSubstr("'maps/secret.png' is refused"),
                          HasSubstr("%2e%2e/secret.png"), kUnknown,
                          "textures of wood are left out on 2 faces without texture coordinates"));
}

TEST_F(ObjWithMaterials, TextureCoordinatesThatAreAllTheSameAreANote) {
  write("p.png", "picture");
  write("f.mtl", "newmtl wood\nmap_Kd p.png\n");
  for (const bool same : {true, false}) {
    write("f.obj", std::string("mtllib f.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt ") +
                       (same ? "0 0" : "0 1") + "\nf 1/1 2/2 3/1\n");
    const MeshFile file = with_materials(folder.path() / "f.obj");
    if (same)
      EXPECT_THAT(file.notes,
                  ElementsAre("all texture coordinates are the same: each texture has one colour"));
    else
      EXPECT_THAT(file.notes, IsEmpty());
  }
}

struct GltfWithMaterials {
  GltfStore store;
  std::string position = store.vec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  std::string picture = store.view("picture of 22 bytes  .");

  [[nodiscard]] MeshFile read(const std::string& material, const std::string& others) const {
    return with_materials(write_file(
        "a.glb",
        store.glb(
            R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" +
            position + R"(},"material":0},{"attributes":{"POSITION":)" + position +
            R"(}}]}],"materials":[{)" + material + "}]" + others)));
  }
};

TEST(GltfMaterials, AreTheirFactorsTexturesAndPlaces) {
  const GltfWithMaterials gltf;
  const MeshFile file = gltf.read(
      R"("name":"glow","alphaMode":"MASK","alphaCutoff":0.25,"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"roughnessFactor":0.5,)"
      R"("baseColorTexture":{"index":0,"texCoord":1}},"emissiveFactor":[1,0.5,0],)"
      R"("normalTexture":{"index":1,"scale":2,"extensions":{"KHR_texture_transform":{"offset":[0,1],)"
      R"("rotation":1.5707963267948966,"scale":[0.5,0.25],"texCoord":2}}})",
      R"(,"textures":[{"source":0,"sampler":0},{"extensions":{"EXT_texture_webp":{"source":0}}}],)"
      R"("samplers":[{"wrapS":33071,"wrapT":33648}],"images":[{"mimeType":"image/png","bufferView":)" +
          gltf.picture + "}]");
  // The mesh has neither set.
  EXPECT_THAT(file.notes,
              ElementsAre("textures of glow are left out on 1 faces without texture coordinates of set 1",
                          "textures of glow are left out on 1 faces without texture coordinates of set 2"));
  ASSERT_EQ(file.materials.size(), 1u);
  const Material& m = file.materials[0];
  EXPECT_EQ(m.name, "glow");
  EXPECT_THAT(m.base_color, ElementsAre(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_THAT(m.emissive, ElementsAre(1, 0.5f, 0));
  EXPECT_FLOAT_EQ(m.metallic, 1);  // glTF's default
  EXPECT_FLOAT_EQ(m.roughness, 0.5f);
  EXPECT_FLOAT_EQ(m.normal_scale, 2);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_FLOAT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_EQ(m.base_color_texture.uv_set, 1u);
  EXPECT_EQ(m.base_color_texture.wrap[0], TextureWrap::clamp);
  EXPECT_EQ(m.base_color_texture.wrap[1], TextureWrap::mirror);
  EXPECT_EQ(m.normal_texture.uv_set, 2u);
  ASSERT_EQ(file.textures.size(), 1u);
  EXPECT_EQ(text_of(file.textures[0]), "picture of 22 bytes  .");
  EXPECT_THAT(file.face_materials, ElementsAre(0, kNone));

  // The extension's own example: a quarter of the picture at its lower left, turned by 90°. With v upwards,
  // (u, v) has the place (s_y (1 − v), s_x u), and (0, 0) is the lower left corner.
  const auto place = [&](double u, double v) {
    const auto& p = m.normal_texture.place;
    return std::array{p[0][0] * u + p[0][1] * v + p[0][2], p[1][0] * u + p[1][1] * v + p[1][2]};
  };
  for (const auto [u, v] : {std::array{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.3, 0.9}}) {
    EXPECT_NEAR(place(u, v)[0], 0.25 * (1 - v), 1e-12);
    EXPECT_NEAR(place(u, v)[1], 0.5 * u, 1e-12);
  }
}

// Regression: the material was white.
TEST(GltfMaterials, SpecularAndGlossyOnesHaveTheirDiffuseColour) {
  const GltfWithMaterials gltf;
  const std::string images =
      R"(,"textures":[{"source":0}],"images":[{"mimeType":"image/png","bufferView":)" + gltf.picture + "}]";
  const std::string glossy =
      R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,1,1,0.5],"glossinessFactor":0.75)";
  const MeshFile file = gltf.read(glossy + "}}", images);
  const Material& m = file.materials.at(0);
  EXPECT_THAT(m.base_color, ElementsAre(0.5f, 1, 1, 0.5f));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_FLOAT_EQ(m.roughness, 0.25f);
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("the specular colour of the material 0 is left out")));
  const MeshFile textured = gltf.read(
      glossy + R"(,"diffuseTexture":{"index":0},"specularGlossinessTexture":{"index":0}}})", images);
  EXPECT_EQ(textured.materials.at(0).base_color_texture.texture, 0u);
  EXPECT_THAT(
      textured.notes,
      ElementsAre(HasSubstr("the picture of specular colour and glossiness of the material 0 is left out"),
                  HasSubstr("1 faces without texture coordinates")));
  // Beside the core model, which is the one to show.
  const MeshFile both =
      gltf.read(R"("pbrMetallicRoughness":{"metallicFactor":0.5},)" + glossy + "}}", images);
  EXPECT_FLOAT_EQ(both.materials.at(0).metallic, 0.5f);
  EXPECT_THAT(both.materials.at(0).base_color, ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(both.notes, IsEmpty());
}

TEST(GltfMaterials, TexturesThatCannotBeHadAreLeftOutWithANote) {
  const GltfWithMaterials gltf;
  const auto notes = [&](const std::string& others) {
    const MeshFile file = gltf.read(R"("emissiveTexture":{"index":0})", others);
    EXPECT_EQ(file.materials.at(0).emissive_texture.texture, kNone);
    EXPECT_EQ(file.mesh.triangles.size(), 1u + 1u);
    return file.notes;
  };
  EXPECT_THAT(notes(""), ElementsAre(HasSubstr("item 0 of textures is referred to but does not exist")));
  EXPECT_THAT(notes(R"(,"textures":[{}])"),
              ElementsAre("the emissiveTexture of the material 0 is left out: it has no picture"));
  EXPECT_THAT(notes(R"(,"textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}])"),
              ElementsAre(HasSubstr("KHR_texture_basisu, which is not supported")));
  EXPECT_THAT(notes(R"(,"textures":[{"source":0}],"images":[{"uri":"../a.png"}])"),
              ElementsAre(HasSubstr("the texture '../a.png' is refused")));
  EXPECT_THAT(notes(R"(,"textures":[{"source":0}],"images":[{"uri":"no%20such.png"}])"),
              ElementsAre(HasSubstr("no such.png")));
  EXPECT_THAT(notes(R"(,"textures":[{"source":0}],"images":[{"bufferView":99}])"),
              ElementsAre(HasSubstr("item 99 of bufferViews")));
  EXPECT_THAT(notes(R"(,"textures":[{"source":0}],"images":[{"uri":7}])"),
              ElementsAre(HasSubstr("not text")));
  EXPECT_THAT(notes(R"(,"textures":[{"source":-1}],"images":[{}])"), ElementsAre(HasSubstr("source")));
}

TEST(GltfMaterials, PicturesOutOfTheFolderAreRefused) {
  const TemporaryFolder outside;
  std::ofstream(outside.path() / "secret.png") << "secret";
  const GltfWithMaterials gltf;
  const auto read = [&](const std::string& uri) {
    return gltf.read(R"("emissiveTexture":{"index":0})",
                     R"(,"textures":[{"source":0}],"images":[{"uri":")" + uri + R"("}])");
  };
  const auto folder = write_file("a.glb", "").parent_path();
  const std::string link = "link to " + outside.path().filename().string();
  std::filesystem::create_symlink(outside.path(), folder / link);
  for (const std::string& uri :
       {std::string("%2e%2e/secret.png"), std::string("%2E%2e%2Fsecret.png"),
        std::string("a/%2e./../secret.png"), link + "/secret.png", outside.path().string() + "/secret.png"}) {
    const MeshFile file = read(uri);
    EXPECT_THAT(file.textures, IsEmpty()) << uri;
    EXPECT_THAT(file.notes, ElementsAre(HasSubstr("is refused"))) << uri;
  }
  std::filesystem::remove(folder / link);
}

TEST(GltfMaterials, ImagesOfOneBufferViewAreOneTexture) {
  const GltfWithMaterials gltf;
  const std::string image = R"({"bufferView":)" + gltf.picture + "}";
  const MeshFile file =
      gltf.read(R"("emissiveTexture":{"index":0},"normalTexture":{"index":1})",
                R"(,"textures":[{"source":0},{"source":1}],"images":[)" + image + "," + image + "]");
  ASSERT_EQ(file.textures.size(), 1u);
  EXPECT_EQ(file.materials[0].emissive_texture.texture, 0u);
  EXPECT_EQ(file.materials[0].normal_texture.texture, 0u);
}

TEST(GltfMaterials, PicturesMayBeEmbeddedAsText) {
  const GltfWithMaterials gltf;
  const MeshFile file = gltf.read(R"("emissiveTexture":{"index":0})",
                                  R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,)" +
                                      base64("picture") + R"("}])");
  ASSERT_EQ(file.textures.size(), 1u);
  EXPECT_EQ(text_of(file.textures[0]), "picture");
}

}  // namespace
}  // namespace sdm::test
