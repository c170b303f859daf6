// Files of an atlas to which an edit has added rows.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <cstring>
#include <fstream>

#include <tiny_gltf.h>

#include "io_write/read_png.h"
#include "support/made_up_maps.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

struct TallAtlas : ::testing::Test {
  static constexpr std::uint32_t kSide = 128;
  Surface surface{ring(24), {.resolution = kSide}};
  DistanceMap map;
  const TemporaryFolder folder;

  TallAtlas() {
    const Mesh more = moved(ring(24), {4, 0, 0});
    MeshEdit edit{.removed_faces = {5}, .added_vertices = more.positions};
    const auto n = static_cast<std::uint32_t>(surface.mesh().positions.size());
    for (const auto& [a, b, c] : more.triangles) edit.added_faces.push_back({a + n, b + n, c + n});
    surface.edit(edit);
    map = map_of(surface, [](const Vec3& p) { return p[0]; });
  }
};

TEST_F(TallAtlas, ExrHasAllRows) {
  ASSERT_GT(surface.rows(), kSide);
  write_exr(folder / "map.exr", surface, map);
  Imf::InputFile exr((folder / "map.exr").c_str());
  const auto window = exr.header().dataWindow();
  ASSERT_EQ(window.max, Imath::V2i(kSide - 1, static_cast<int>(surface.rows()) - 1));
  std::vector<float> distance(surface.texel_faces().size());
  Imf::FrameBuffer frame;
  frame.insert("distance.D",
               Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(distance.data()), 4, std::size_t{4} * kSide));
  exr.setFrameBuffer(frame);
  exr.readPixels(0, window.max.y);
  for (const std::uint32_t texel : test::owned_texels(surface))
    ASSERT_EQ(distance[texel], map.distance[texel]);
}

TEST_F(TallAtlas, PicturesHaveAllRows) {
  write_direction_png(folder / "direction.png", surface, map);
  const Pixels pixels = read_png(folder / "direction.png");
  EXPECT_EQ(pixels.width, kSide);
  EXPECT_EQ(pixels.height, surface.rows());
  write_distance_png(folder / "distance.png", surface, map, {.largest = 64});
  EXPECT_LE(read_png(folder / "distance.png").width, 64u + 400);
}

// Regression: only squares were written.
TEST_F(TallAtlas, NumbersOfTexelsHaveAllRows) {
  const auto faces = surface.texel_faces();
  write_npy(folder / "face.npy", kSide, faces);
  std::ifstream in(folder / "face.npy", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(bytes.find("'shape': (" + std::to_string(surface.rows()) + ", 128)"), std::string::npos);
  ASSERT_EQ(bytes.size(), 128 + 4 * faces.size());
  EXPECT_EQ(std::memcmp(bytes.data() + 128, faces.data(), 4 * faces.size()), 0);
  EXPECT_THROW(write_npy(folder / "part.npy", kSide, faces.first(kSide + 1)), Error);
  EXPECT_THROW(write_npy(folder / "none.npy", kSide, faces.first(0)), Error);
}

TEST_F(TallAtlas, TheModelsCoordinatesReferToAllRows) {
  write_glb(folder / "model.glb", surface, map,
            at_vertices(surface.mesh(), [](const Vec3& p) { return p[0]; }));
  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(
      tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, (folder / "model.glb").string()))
      << error;
  EXPECT_EQ(model.images.at(0).width, static_cast<int>(kSide));
  EXPECT_EQ(model.images.at(0).height, static_cast<int>(surface.rows()));
  std::size_t triangles = 0;
  for (const auto& primitive : model.meshes.at(0).primitives)
    triangles += model.accessors[primitive.indices].count / 3;
  EXPECT_EQ(triangles, surface.mesh().triangles.size() - 1);  // but for the removed one
}

// Texture coordinates of the file are those of the mesh, and all files have the shape.
TEST(WideAtlas, FilesHaveItsShape) {
  const TemporaryFolder folder;
  const Mesh mesh = height_field(6);
  const Surface surface(mesh, {.kind = AtlasKind::uv, .resolution = 200, .rows = 48});
  const Field field = [](const Vec3& p) { return p[0]; };
  const DistanceMap map = map_of(surface, field);
  write_exr(folder / "map.exr", surface, map);
  const auto window = Imf::InputFile((folder / "map.exr").c_str()).header().dataWindow();
  EXPECT_EQ(window.max, Imath::V2i(199, 47));
  write_direction_png(folder / "direction.png", surface, map);
  EXPECT_EQ(read_png(folder / "direction.png").width, 200u);
  EXPECT_EQ(read_png(folder / "direction.png").height, 48u);
  write_direction_png(folder / "direction.png", surface, map, {.largest = 100});
  EXPECT_EQ(read_png(folder / "direction.png").width, 100u);
  EXPECT_EQ(read_png(folder / "direction.png").height, 24u);
  write_glb(folder / "model.glb", surface, map, at_vertices(mesh, field));
  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(
      tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, (folder / "model.glb").string()));
  EXPECT_EQ(model.images.at(0).width, 200);
  EXPECT_EQ(model.images.at(0).height, 48);
  const auto floats = [&](const char* name) {
    const auto& accessor = model.accessors[model.meshes[0].primitives[0].attributes.at(name)];
    const auto& view = model.bufferViews[accessor.bufferView];
    return reinterpret_cast<const float*>(model.buffers[0].data.data() + view.byteOffset +
                                          accessor.byteOffset);
  };
  const float *place = floats("TEXCOORD_0"), *position = floats("POSITION");
  const std::size_t count = model.accessors[model.meshes[0].primitives[0].attributes.at("POSITION")].count;
  ASSERT_GE(count, mesh.positions.size());
  for (std::size_t i = 0; i < count; ++i) {  // the ground plane of the height field
    EXPECT_NEAR(place[2 * i], position[3 * i], 1e-6);
    EXPECT_NEAR(place[2 * i + 1], 1 - position[3 * i + 1], 1e-6);
  }
}

}  // namespace
}  // namespace sdm::test
