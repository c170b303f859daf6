// Normals, colours and other numbers that files have at the corners of faces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "io_read/gltf_store.h"
#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

MeshFile with_attributes(const std::string& name, std::string_view contents) {
  return read_mesh_file(write_file(name, contents), {.attributes = true});
}

std::vector<std::string> names_of(const MeshFile& file) {
  std::vector<std::string> names;
  for (const MeshAttribute& attribute : file.attributes) names.push_back(attribute.name);
  return names;
}

/// The row of a corner; empty if the file has none.
std::vector<float> at(const MeshFile& file, std::string_view name, std::size_t face, std::size_t corner) {
  for (const MeshAttribute& attribute : file.attributes) {
    if (attribute.name != name) continue;
    EXPECT_EQ(attribute.rows->size(), file.mesh.triangles.size());
    const std::uint32_t row = (*attribute.rows)[face][corner];
    if (row == kNone) return {};
    const auto begin = attribute.values.begin() + static_cast<std::ptrdiff_t>(row * attribute.components);
    return {begin, begin + static_cast<std::ptrdiff_t>(attribute.components)};
  }
  ADD_FAILURE() << "there is no attribute " << name;
  return {};
}

// Half of the intensity in sRGB, in linear light: ((0.5 + 0.055) / 1.055)^2.4.
constexpr float kHalf = 0.21404114f;

TEST(Attributes, OfObjAreNormalsOfCornersAndColorsOfVertices) {
  // Two faces share an edge but not its normals; the second is a quad, whose triangles keep them.
  const MeshFile file =
      with_attributes("a.obj",
                      "v 0 0 0 1 0.5 0\nv 1 0 0 0 1 0\nv 0 1 0\nv 1 1 1 0 0 1\nv 0 2 1 1 1 1\n"
                      "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 3//2 2//2 4//-1 5\nf 1 2\n");
  EXPECT_THAT(names_of(file), ElementsAre("normal", "color"));
  ASSERT_EQ(file.mesh.triangles.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_THAT(at(file, "normal", 0, k), ElementsAre(0, 0, 1));
  std::size_t without = 0;
  for (std::size_t f = 1; f < 3; ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const bool is_fifth = file.mesh.positions[file.mesh.triangles[f][k]] == Vec3{0, 2, 1};
      without += is_fifth;
      if (is_fifth)
        EXPECT_THAT(at(file, "normal", f, k), IsEmpty());
      else
        EXPECT_THAT(at(file, "normal", f, k), ElementsAre(0, 1, 0));
    }
  EXPECT_GT(without, 0u);
  const auto color = at(file, "color", 0, 0);
  EXPECT_FLOAT_EQ(color[0], 1);
  EXPECT_NEAR(color[1], kHalf, 1e-6f);
  EXPECT_FLOAT_EQ(color[2], 0);
  EXPECT_TRUE(std::isnan(at(file, "color", 0, 2)[0]));  // a vertex without a colour
}

TEST(Attributes, OfObjThatAreNotThereAreNone) {
  const MeshFile file =
      with_attributes("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0 1\nvn 0 0 1\nf 1//1 2//7 3//-5\n");
  EXPECT_THAT(names_of(file), ElementsAre("normal"));
  EXPECT_THAT(at(file, "normal", 0, 0), ElementsAre(0, 0, 1));
  EXPECT_THAT(at(file, "normal", 0, 1), IsEmpty());
  EXPECT_THAT(at(file, "normal", 0, 2), IsEmpty());
  EXPECT_TRUE(read_mesh_file(write_file("b.obj", obj(tetrahedron()))).attributes.empty());
}

constexpr std::string_view kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\nproperty float quality\nelement face 3\nproperty list uchar int vertex_indices\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty int "
    "label\n"
    "end_header\n"
    "0 0 0 0 0 1 255 0 0 0.25\n1 0 0 0 0 1 0 255 0 1\n1 1 0 0 0 1 0 0 255 2\n0 1 0 0 1 0 128 128 128 4\n"
    "4 0 1 2 3 255 255 255 51 7\n2 0 1 0 0 0 0 8\n3 0 1 2 0 0 0 255 9\n";

TEST(Attributes, OfPlyAreThoseOfVerticesAndOfFaces) {
  const MeshFile file = with_attributes("a.ply", kPly);
  EXPECT_THAT(names_of(file), ElementsAre("normal", "color", "quality", "face_color", "label"));
  ASSERT_EQ(file.mesh.triangles.size(), 3u);  // a quad and a triangle; the face of two corners is none
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = file.mesh.positions[file.mesh.triangles[f][k]];
      const std::size_t vertex = p[1] == 0 ? (p[0] == 0 ? 0 : 1) : (p[0] == 0 ? 3 : 2);
      EXPECT_THAT(at(file, "quality", f, k), ElementsAre(std::array{0.25f, 1.f, 2.f, 4.f}[vertex]));
      EXPECT_THAT(at(file, "label", f, k), ElementsAre(f < 2 ? 7.f : 9.f));
      EXPECT_FLOAT_EQ(at(file, "face_color", f, k)[3], f < 2 ? 0.2f : 1.f);
      const float of_128 = 0.2158605f, green = vertex == 1 ? 1 : vertex == 3 ? of_128 : 0;
      EXPECT_NEAR(at(file, "color", f, k)[1], green, 1e-6f);
    }
}

TEST(Attributes, OfBinaryPlyAreTheSame) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nproperty ushort diffuse_red\nproperty ushort diffuse_green\nproperty ushort "
      "diffuse_blue\nproperty short scalar_heat\nelement face 1\nproperty list uchar uint "
      "vertex_index\nend_header\n";
  for (int v = 0; v < 3; ++v) {
    for (int k = 0; k < 3; ++k) put(bytes, k + 1 == v ? 1.0 : 0.0, std::endian::big);
    for (const int c : {65535, 0, 0}) put(bytes, static_cast<std::uint16_t>(c), std::endian::big);
    put(bytes, static_cast<std::int16_t>(-5 + v), std::endian::big);
  }
  put(bytes, std::uint8_t{3});
  for (std::uint32_t v = 0; v < 3; ++v) put(bytes, v, std::endian::big);
  const MeshFile file = with_attributes("a.ply", bytes);
  EXPECT_THAT(names_of(file), ElementsAre("color", "scalar_heat"));
  EXPECT_THAT(at(file, "color", 0, 1), ElementsAre(1, 0, 0));
  EXPECT_THAT(at(file, "scalar_heat", 0, 2), ElementsAre(-3));
}

// Faces in strips have none of the numbers of the other faces.
TEST(Attributes, ThatDoNotCoverAllFacesAreLeftOutWithANote) {
  const MeshFile file = with_attributes(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty int label\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 5\n3 1 2 3\n");
  EXPECT_EQ(file.mesh.triangles.size(), 2u);
  EXPECT_THAT(file.attributes, IsEmpty());
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("`label` is left out")));
}

struct GltfOfTwoPrimitives {
  GltfStore store;
  std::string position = store.vec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  std::string normal = store.vec3({{0, 0, 1}, {0, 0, 1}, {0, 0.6, 0.8}});
  std::string color =
      store.rows<std::uint8_t>("VEC4", 3, std::vector<int>{255, 0, 0, 255, 0, 51, 0, 255, 0, 0, 255, 0}, 5121,
                               R"(,"normalized":true)");
  std::string heat = store.rows<float>("SCALAR", 3, std::vector<float>{1, 2, 3});
  std::string uv1 = store.rows<float>("VEC2", 3, std::vector<float>{0, 0, 1, 0, 0, 1});

  [[nodiscard]] MeshFile read(const std::string& attributes, const std::string& node = "") const {
    return with_attributes("a.glb",
                           store.glb(R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
                                     R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" + position +
                                     R"(}},{"attributes":{"POSITION":)" + position + attributes + "}}]}]"));
  }
};

TEST(Attributes, OfGltfAreThoseOfEachPrimitive) {
  const GltfOfTwoPrimitives gltf;
  const MeshFile file = gltf.read(R"(,"NORMAL":)" + gltf.normal + R"(,"COLOR_0":)" + gltf.color +
                                  R"(,"_HEAT":)" + gltf.heat + R"(,"TEXCOORD_1":)" + gltf.uv1);
  ASSERT_EQ(file.mesh.triangles.size(), 2u);
  EXPECT_THAT(names_of(file), ::testing::UnorderedElementsAre("normal", "color", "_HEAT", "uv1"));
  EXPECT_TRUE(std::isnan(at(file, "color", 0, 0)[0]));  // of the primitive without colours
  EXPECT_THAT(at(file, "color", 1, 1), ElementsAre(0, 0.2f, 0, 1));
  EXPECT_THAT(at(file, "color", 1, 2), ElementsAre(0, 0, 1, 0));
  EXPECT_THAT(at(file, "_HEAT", 1, 2), ElementsAre(3));
  EXPECT_THAT(at(file, "uv1", 1, 2), ElementsAre(0, 0));  // v points down in glTF
}

// By the inverse transpose: a plane that is scaled along z only keeps its slope's other part.
TEST(Attributes, NormalsOfGltfFollowTheirNodes) {
  const GltfOfTwoPrimitives gltf;
  const std::string attributes = R"(,"NORMAL":)" + gltf.normal;
  const MeshFile scaled = gltf.read(attributes, R"(,"scale":[1,1,2])");
  const Vec3 expected = normalized(Vec3{0, 0.6, 0.4});
  const auto found = at(scaled, "normal", 1, 2);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-6);
  const MeshFile mirrored = gltf.read(attributes, R"(,"scale":[1,1,-1])");
  const auto& t = mirrored.mesh.triangles[1];
  const auto& p = mirrored.mesh.positions;
  const Vec3 of_face = cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
  EXPECT_LT(of_face[2], 0);
  EXPECT_THAT(at(mirrored, "normal", 1, 0), ElementsAre(0, 0, -1));
}

TEST(Attributes, OfGltfThatDoNotFitAreRefused) {
  const GltfOfTwoPrimitives gltf;
  const auto fault = [&](const std::string& attributes) {
    try {
      (void)gltf.read(attributes);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(fault(R"(,"NORMAL":)" + gltf.heat), HasSubstr("the attribute NORMAL has 1 components"));
  EXPECT_THAT(fault(R"(,"COLOR_0":)" + gltf.uv1), HasSubstr("the attribute COLOR_0 has 2 components"));
  GltfOfTwoPrimitives longer;
  const std::string four = longer.store.rows<float>("SCALAR", 4, std::vector<float>{1, 2, 3, 4});
  EXPECT_THROW((void)longer.read(R"(,"_HEAT":)" + four), Error);
}

}  // namespace
}  // namespace sdm::test
