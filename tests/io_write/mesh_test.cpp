// Meshes as files: what write_mesh() writes, read_mesh() returns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <numeric>

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

/// A torus that has all that files keep: normals that jump at each face, colours that jump in one, two
/// materials, one with a picture that is turned, and names.
struct Furnished {
  Mesh mesh = torus(12, 8);
  std::vector<MeshAttribute> attributes;
  std::vector<Material> materials{2};
  std::vector<TextureFile> textures{1};
  std::vector<std::uint32_t> face_materials;
  std::vector<FaceNames> names{{"object", {"left half", "right half"}, {}}, {"group", {"a b", "c"}, {}}};

  Furnished() {
    const std::size_t faces = mesh.triangles.size();
    std::vector<Triangle> of_faces, of_vertices = mesh.triangles;
    MeshAttribute normal{.name = "normal", .components = 3, .values = {}, .rows = {}};
    MeshAttribute color{.name = "color", .components = 3, .values = {}, .rows = {}};
    for (std::uint32_t f = 0; f < faces; ++f) {
      const auto& [a, b, c] = mesh.triangles[f];
      const Vec3 n =
          normalized(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
      for (const double x : n) normal.values.push_back(static_cast<float>(x));
      of_faces.push_back({f, f, f});
      face_materials.push_back(f % 2);
      names[0].of_face.push_back(f < faces / 2 ? 0 : 1);
      names[1].of_face.push_back(f % 3 == 2 ? kNone : f % 3);
    }
    for (std::size_t v = 0; v <= mesh.positions.size(); ++v)
      for (const std::size_t k : {1u, 3u, 7u})
        color.values.push_back(linear_light(static_cast<float>(v * k % 256) / 255.f));
    of_vertices[5].fill(static_cast<std::uint32_t>(mesh.positions.size()));
    normal.rows = std::make_shared<const std::vector<Triangle>>(of_faces);
    color.rows = std::make_shared<const std::vector<Triangle>>(of_vertices);
    attributes = {normal, color};
    textures[0] = {"dots",
                   encode_png({.width = 2, .height = 1, .components = 3, .bytes = {255, 0, 0, 0, 0, 255}})};
    materials[0].name = "plain";
    materials[0].base_color = {linear_light(51 / 255.f), linear_light(102 / 255.f), 1, 0.5f};
    materials[0].alpha_mode = AlphaMode::blend;
    materials[0].metallic = 0.25f;
    materials[0].roughness = 0.5f;
    materials[1].name = "with dots";
    materials[1].emissive = {linear_light(51 / 255.f), 0, 0};
    materials[1].base_color_texture = {.texture = 0,
                                       .uv_set = 0,
                                       .place = {{{2, 0, 0.25}, {0, 3, 0.5}}},
                                       .wrap = {TextureWrap::clamp, TextureWrap::clamp}};
  }
  [[nodiscard]] MeshExtras extras() const {
    return {.attributes = attributes,
            .materials = materials,
            .textures = textures,
            .face_materials = face_materials,
            .names = names};
  }
};

std::vector<float> at_corners(const MeshAttribute& attribute, std::size_t components) {
  std::vector<float> values;
  for (const Triangle& t : *attribute.rows)
    for (const std::uint32_t row : t)
      for (std::size_t k = 0; k < components; ++k)
        values.push_back(attribute.values[attribute.components * row + k]);
  return values;
}

void expect_attributes(const MeshFile& read, const Furnished& written, double tolerance) {
  for (const MeshAttribute& attribute : written.attributes) {
    const auto found = std::ranges::find(read.attributes, attribute.name, &MeshAttribute::name);
    ASSERT_NE(found, read.attributes.end()) << attribute.name;
    EXPECT_THAT(
        at_corners(*found, 3),
        ::testing::Pointwise(::testing::FloatNear(static_cast<float>(tolerance)), at_corners(attribute, 3)))
        << attribute.name;
  }
}

// The faces are those of the file, in its order: parts of GLB come one after the other.
void sort_as_glb(Furnished& furnished) {
  const std::size_t faces = furnished.mesh.triangles.size();
  std::vector<std::uint32_t> order(faces);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t f) {
    return std::pair(furnished.names[0].of_face[f], furnished.face_materials[f]);
  });
  const auto sort = [&](auto& array) {
    auto sorted = array;
    for (std::size_t i = 0; i < faces; ++i) sorted[i] = array[order[i]];
    array = std::move(sorted);
  };
  sort(furnished.mesh.triangles);
  sort(furnished.mesh.corner_uvs);
  sort(furnished.face_materials);
  for (FaceNames& names : furnished.names) sort(names.of_face);
  for (MeshAttribute& attribute : furnished.attributes) {
    std::vector<Triangle> rows = *attribute.rows;
    sort(rows);
    attribute.rows = std::make_shared<const std::vector<Triangle>>(std::move(rows));
  }
}

const FaceNames& names_of(const MeshFile& read, const std::string& kind) {
  static const FaceNames kMissing;
  const auto found = std::ranges::find(read.names, kind, &FaceNames::kind);
  return found == read.names.end() ? kMissing : *found;
}

TEST(WriteMesh, KeepsNormalsColoursMaterialsAndNames) {
  const TemporaryFolder folder;
  Furnished written;
  write_mesh(folder / "mesh.ply", written.mesh, written.extras());
  expect_attributes(read_mesh_file(folder / "mesh.ply", {.attributes = true}), written, 1e-6);
  write_mesh(folder / "mesh.stl", written.mesh, written.extras());
  EXPECT_EQ(read_mesh(folder / "mesh.stl").triangles.size(), written.mesh.triangles.size());

  for (const char* name : {"mesh.obj", "mesh.glb"}) {
    SCOPED_TRACE(name);
    if (std::string(name) == "mesh.glb") sort_as_glb(written);
    write_mesh(folder / name, written.mesh, written.extras());
    const MeshFile read = read_mesh_file(folder / name, {.attributes = true});
    EXPECT_THAT(read.notes, ::testing::IsEmpty());
    ASSERT_EQ(read.mesh.triangles.size(), written.mesh.triangles.size());
    expect_attributes(read, written, 1e-6);
    EXPECT_EQ(read.face_materials, written.face_materials);
    EXPECT_EQ(names_of(read, "object").names, written.names[0].names);
    EXPECT_EQ(names_of(read, "object").of_face, written.names[0].of_face);
    ASSERT_EQ(read.materials.size(), 2u);
    ASSERT_EQ(read.textures.size(), 1u);
    EXPECT_EQ(read.textures[0].bytes, written.textures[0].bytes);
    for (std::size_t m = 0; m < 2; ++m) {
      const Material &found = read.materials[m], &wanted = written.materials[m];
      EXPECT_EQ(found.name, wanted.name);
      EXPECT_EQ(found.alpha_mode, wanted.alpha_mode);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found.base_color[k], wanted.base_color[k], 1e-6);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.emissive[k], wanted.emissive[k], 1e-6);
      EXPECT_EQ(found.metallic, wanted.metallic);
      EXPECT_EQ(found.roughness, wanted.roughness);
      EXPECT_EQ(found.base_color_texture.texture, wanted.base_color_texture.texture);
      EXPECT_EQ(found.base_color_texture.wrap, wanted.base_color_texture.wrap);
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR(found.base_color_texture.place[i][k], wanted.base_color_texture.place[i][k], 1e-6);
    }
  }
  const MeshFile obj = read_mesh_file(folder / "mesh.obj", {.attributes = true});
  const FaceNames& groups = names_of(obj, "group");
  EXPECT_EQ(groups.names[groups.of_face[0]], "a b");
  EXPECT_EQ(groups.names[groups.of_face[1]], "c");
  written.materials[0].base_color_texture.texture = 0;  // or the validator reports unused coordinates
  write_mesh(folder / "textured.glb", written.mesh, written.extras());
  const std::string validate = "cd '" SDM_VALIDATOR_FOLDER "' && node '" SDM_VALIDATOR_SCRIPT "' '" +
                               (folder / "textured.glb").string() + "'";
  EXPECT_EQ(std::system(validate.c_str()), 0);
}

TEST(WriteMesh, RefusesWhatBelongsToOtherFaces) {
  const TemporaryFolder folder;
  Furnished written;
  const auto expect_refused = [&] {
    for (const char* name : {"mesh.ply", "mesh.obj", "mesh.glb"})
      EXPECT_THROW(write_mesh(folder / name, written.mesh, written.extras()), Error) << name;
  };
  written.face_materials[3] = 2;
  expect_refused();
  written.face_materials.pop_back();
  expect_refused();
  written = {};
  written.names[1].of_face[0] = 9;
  expect_refused();
  written = {};
  written.attributes[0].values.resize(12);
  expect_refused();
  EXPECT_TRUE(folder.empty());
}

TEST(WriteMesh, RefusesInvalidMeshes) {
  const TemporaryFolder folder;
  Mesh without_vertex = cube(), infinite = cube();
  without_vertex.triangles[0][1] = 8;
  infinite.positions[0][0] = std::numeric_limits<double>::infinity();
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.glb"})
    for (const Mesh& mesh : {without_vertex, infinite, Mesh{}})
      EXPECT_THROW(write_mesh(folder / name, mesh), Error) << name;
  EXPECT_TRUE(folder.empty());
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
