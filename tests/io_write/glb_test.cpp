#include "io/image/pictures/color_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/sites.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "io/page/player/sequence_player.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using namespace io;

tinygltf::Model read_glb(const std::filesystem::path& file) {
  tinygltf::Model model;
  std::string errors, warnings;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &errors, &warnings, file.string())) << errors;
  EXPECT_EQ(warnings, "");
  return model;
}

template <class Element>
std::vector<Element> values(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  std::vector<Element> result(view.byteLength / sizeof(Element));
  std::memcpy(result.data(), model.buffers[0].data.data() + view.byteOffset, view.byteLength);
  return result;
}

/// The texture as viewers sample it: bilinear, clamped; in [0, 255].
std::array<double, 3> sample(const tinygltf::Image& image, const std::array<float, 2>& uv) {
  const double x = double{uv[0]} * image.width - 0.5, y = double{uv[1]} * image.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  std::array<double, 3> color{};
  for (int k = 0; k < 4; ++k) {
    const int ix = std::clamp(x0 + k % 2, 0, image.width - 1),
              iy = std::clamp(y0 + k / 2, 0, image.height - 1);
    const double weight = (k % 2 ? x - x0 : 1 - (x - x0)) * (k / 2 ? y - y0 : 1 - (y - y0));
    const int first = (iy * image.width + ix) * image.component;
    for (int c = 0; c < 3; ++c) color[c] += weight * image.image[first + c];
  }
  return color;
}

TEST(Glb, VertexColoursMatchTheirDistances) {
  const Field field = [](const Vec3& p) { return p[0]; };
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
    const Surface surface(ring(24), {.kind = kind, .resolution = 1024});
    const DistanceMap map = map_of(surface, field);
    const PictureOptions options{.colormap = Colormap::viridis};
    const TemporaryFolder folder;
    write_glb(folder / "model.glb", surface, map, at_vertices(surface.mesh(), field), options);
    const tinygltf::Model model = read_glb(folder / "model.glb");
    const ColorScale scale = color_scale(surface, map, options);
    ASSERT_EQ(model.meshes[0].primitives.size(), 1u);
    const auto& primitive = model.meshes[0].primitives[0];
    const auto uvs = values<std::array<float, 2>>(model, primitive.attributes.at("TEXCOORD_0"));
    const auto distances = values<float>(model, primitive.attributes.at("_DISTANCE"));
    ASSERT_EQ(uvs.size(), distances.size());
    for (std::size_t i = 0; i < uvs.size(); ++i) {
      const auto color = sample(model.images[0], uvs[i]);
      const Rgb expected = scale(distances[i]);
      ASSERT_NEAR(color[0], expected.r, 8) << i;
      ASSERT_NEAR(color[1], expected.g, 8) << i;
      ASSERT_NEAR(color[2], expected.b, 8) << i;
    }
  }
}

TEST(Glb, ContainsTheMesh) {
  const Field field = [](const Vec3& p) { return p[0]; };
  const Surface surface(ring(9), {.resolution = 256});
  const Mesh& mesh = surface.mesh();
  const TemporaryFolder folder;
  write_glb(folder / "model.glb", surface, map_of(surface, field), at_vertices(mesh, field));
  const tinygltf::Model model = read_glb(folder / "model.glb");
  const auto& primitive = model.meshes[0].primitives.at(0);
  const auto triangles = values<Triangle>(model, primitive.indices);
  const auto positions = values<Vec3f>(model, primitive.attributes.at("POSITION"));
  const auto distances = values<float>(model, primitive.attributes.at("_DISTANCE"));
  const auto uvs = values<std::array<float, 2>>(model, primitive.attributes.at("TEXCOORD_0"));
  ASSERT_EQ(triangles.size(), mesh.triangles.size());
  for (std::uint32_t face = 0; face < triangles.size(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t i = triangles[face][corner];
      const Vec3& p = mesh.positions[mesh.triangles[face][corner]];
      EXPECT_EQ(positions[i],
                (Vec3f{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}));
      EXPECT_EQ(distances[i], static_cast<float>(p[0]));
      const Vec2 place = surface.to_atlas(face, p);
      EXPECT_NEAR(uvs[i][0] * 256, place[0], 0.02);
      EXPECT_NEAR(uvs[i][1] * 256, place[1], 0.02);
    }
  // Vertices are shared within a chart: far fewer than three a face.
  EXPECT_LT(positions.size(), 2 * triangles.size());
}

TEST(Glb, ScalesToMetresAndKeepsPrecisionFarFromTheOrigin) {
  const Field field = [](const Vec3&) { return 1; };
  const Vec3 far{4e6, -5e6, 1e6};
  const Surface surface(ring(6, 1, far), {.kind = AtlasKind::triangles, .resolution = 256});
  const TemporaryFolder folder;
  write_glb(folder / "model.glb", surface, map_of(surface, field), at_vertices(surface.mesh(), field),
            {.units = "mm"});
  const tinygltf::Model model = read_glb(folder / "model.glb");
  const tinygltf::Node& node = model.nodes[0];
  ASSERT_EQ(node.scale, std::vector<double>(3, 1e-3));
  const auto& primitive = model.meshes[0].primitives[0];
  const auto positions = values<Vec3f>(model, primitive.attributes.at("POSITION"));
  const auto triangles = values<Triangle>(model, primitive.indices);
  for (std::size_t face = 0; face < triangles.size(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3& p = surface.mesh().positions[surface.mesh().triangles[face][corner]];
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(positions[triangles[face][corner]][k] * 1e-3 + node.translation[k], p[k] * 1e-3, 1e-9);
    }
}

/// The normals of the model of a mesh, and the vertices' positions.
std::pair<std::vector<Vec3f>, std::vector<Vec3f>> normals_of(const Mesh& mesh) {
  const Field field = [](const Vec3&) { return 1; };
  const Surface surface(mesh, {.resolution = 256});
  const TemporaryFolder folder;
  write_glb(folder / "model.glb", surface, map_of(surface, field), at_vertices(mesh, field));
  const tinygltf::Model model = read_glb(folder / "model.glb");
  const auto& attributes = model.meshes[0].primitives.at(0).attributes;
  return {values<Vec3f>(model, attributes.at("NORMAL")), values<Vec3f>(model, attributes.at("POSITION"))};
}

TEST(Glb, NormalsAreSmoothOnSmoothSurfaces) {
  const auto [normals, positions] = normals_of(sphere(4));
  for (std::size_t i = 0; i < normals.size(); ++i) {
    double cosine = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
      cosine += double{normals[i][k]} * positions[i][k];
      length += double{positions[i][k]} * positions[i][k];
    }
    EXPECT_GT(cosine / std::sqrt(length), 0.99) << i;
  }
}

TEST(Glb, NormalsAreThoseOfTheFacesAtSharpEdges) {
  const auto [normals, positions] = normals_of(cube());
  for (const Vec3f& n : normals) {
    const double most = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
    EXPECT_NEAR(most, 1, 1e-6);
  }
  EXPECT_EQ(normals.size(), 24u);
}

TEST(Glb, IsLitUnlessAskedOtherwise) {
  const Field field = [](const Vec3& p) { return p[0]; };
  const Surface surface(ring(6), {.resolution = 128});
  const DistanceMap map = map_of(surface, field);
  const TemporaryFolder folder;
  for (const bool unlit : {false, true}) {
    write_glb(folder / "model.glb", surface, map, at_vertices(surface.mesh(), field), {.unlit = unlit});
    const tinygltf::Model model = read_glb(folder / "model.glb");
    EXPECT_EQ(model.materials.at(0).extensions.count("KHR_materials_unlit"), unlit ? 1u : 0u);
    EXPECT_EQ(model.extensionsUsed.size(), unlit ? 1u : 0u);
    EXPECT_EQ(model.materials[0].pbrMetallicRoughness.metallicFactor, 0);
    EXPECT_EQ(model.materials[0].pbrMetallicRoughness.roughnessFactor, 1);
  }
}

// By glTF's quaternions (x, y, z, w): the point v becomes v + 2 q × (q × v + w v).
TEST(Glb, TurnsTheUpAxisOfTheMeshToY) {
  const Field field = [](const Vec3&) { return 1; };
  const Vec3 far{4e6, -5e6, 1e6};
  const Surface surface(ring(6, 1, far), {.kind = AtlasKind::triangles, .resolution = 256});
  const TemporaryFolder folder;
  write_glb(folder / "model.glb", surface, map_of(surface, field), at_vertices(surface.mesh(), field),
            {.units = "mm", .up = UpAxis::z});
  const tinygltf::Model model = read_glb(folder / "model.glb");
  const tinygltf::Node& node = model.nodes[0];
  ASSERT_EQ(node.rotation.size(), 4u);
  const Vec3 q{node.rotation[0], node.rotation[1], node.rotation[2]};
  const double w = node.rotation[3];
  const auto& primitive = model.meshes[0].primitives[0];
  const auto positions = values<Vec3f>(model, primitive.attributes.at("POSITION"));
  const auto triangles = values<Triangle>(model, primitive.indices);
  for (std::size_t face = 0; face < triangles.size(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3f& stored = positions[triangles[face][corner]];
      const Vec3 v{1e-3 * stored[0], 1e-3 * stored[1], 1e-3 * stored[2]};
      const Vec3 turned = v + 2.0 * cross(q, cross(q, v) + w * v);
      const Vec3& p = surface.mesh().positions[surface.mesh().triangles[face][corner]];
      const Vec3 upright{1e-3 * p[0], 1e-3 * p[2], -1e-3 * p[1]};
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(turned[k] + node.translation[k], upright[k], 1e-9);
    }
}

TEST(Glb, ContainsFacesWithoutAValue) {
  for (const double none : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const Field field = [none](const Vec3& p) { return p[0] < 0 ? p[1] : none; };
    const Surface surface(ring(9), {.resolution = 256});
    const TemporaryFolder folder;
    write_glb(folder / "model.glb", surface, map_of(surface, field), at_vertices(surface.mesh(), field));
    const tinygltf::Model model = read_glb(folder / "model.glb");
    ASSERT_EQ(model.meshes[0].primitives.size(), 2u);
    const auto &with = model.meshes[0].primitives[0], &without = model.meshes[0].primitives[1];
    EXPECT_EQ(without.attributes.count("_DISTANCE"), 0u);
    EXPECT_THAT(values<float>(model, with.attributes.at("_DISTANCE")),
                ::testing::Each(::testing::Truly([](float d) { return std::isfinite(d); })));
    EXPECT_EQ(values<Triangle>(model, with.indices).size() + values<Triangle>(model, without.indices).size(),
              surface.mesh().triangles.size());
  }
}

TEST(Glb, RejectsMismatchedVertexDistances) {
  const Field field = [](const Vec3&) { return 1; };
  const Surface surface(ring(4), {.resolution = 128});
  const TemporaryFolder folder;
  const std::vector<float> too_few(3);
  EXPECT_THROW(write_glb(folder / "model.glb", surface, map_of(surface, field), too_few), Error);
  EXPECT_TRUE(folder.empty());
}

// Frame i is the first one and morph target i − 1: in the file they are the frames, and the colours those of
// their distances.
TEST(Glb, AnimationsHaveTheFramesAsMorphTargets) {
  const TemporaryFolder folder;
  const Mesh mesh = sphere(3);
  const Sites plane(square(8, -3));
  SequencePlayer player(mesh, plane.mesh(), false);
  EXPECT_THROW(player.write_glb(folder / "no.glb"), Error);
  std::vector<Mesh> frames;
  for (int i = 0; i < 5; ++i) {
    frames.push_back(moved(mesh, {0, 0.1 * i, 0.5 * i}));
    player.add(static_cast<std::size_t>(10 + i), Sites(frames.back()), plane);
  }
  const PlayerOptions options{.colors = {.colormap = Colormap::viridis, .range = {{1, 7}}},
                              .frames_per_second = 10};
  ASSERT_EQ(player.write_glb(folder / "animation.glb", options), 5u);
  const tinygltf::Model model = read_glb(folder / "animation.glb");
  const auto floats = [&](int number) {
    const auto& accessor = model.accessors[number];
    const auto& view = model.bufferViews[accessor.bufferView];
    return reinterpret_cast<const float*>(model.buffers[0].data.data() + view.byteOffset +
                                          accessor.byteOffset);
  };
  const auto& primitive = model.meshes.at(0).primitives.at(0);
  ASSERT_EQ(primitive.targets.size(), 4u);
  EXPECT_TRUE(model.meshes.at(1).primitives.at(0).targets.empty());  // at rest, without colours
  const std::size_t vertices = model.accessors[primitive.attributes.at("POSITION")].count;
  ASSERT_GE(vertices, mesh.positions.size());  // coarse bodies are drawn with more
  const auto linear = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  const io::ColorScale scale = io::color_scale(fixed_colors(options.colors, DistanceStatistics{}));
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (std::size_t v = 0; v < vertices; ++v) {
      const auto value = [&](const char* name, int k) {
        const double base = floats(primitive.attributes.at(name))[3 * v + k];
        return f == 0 ? base : base + floats(primitive.targets[f - 1].at(name))[3 * v + k];
      };
      const float* first = floats(primitive.attributes.at("POSITION")) + 3 * v;
      const double moved[] = {0, 0.1 * static_cast<double>(f), 0.5 * static_cast<double>(f)};
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(value("POSITION", k), first[k] + moved[k], 1e-6);
      const auto rgb = scale(value("POSITION", 2) + 3);
      ASSERT_NEAR(value("COLOR_0", 0), linear(rgb.r / 255.0), 0.02);  // one step of a colour
      ASSERT_NEAR(value("COLOR_0", 1), linear(rgb.g / 255.0), 0.02);
    }
  ASSERT_EQ(model.animations.size(), 1u);
  const auto& sampler = model.animations[0].samplers.at(0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_FLOAT_EQ(floats(sampler.input)[i], 0.1f * static_cast<float>(i));
    for (int k = 0; k < 4; ++k) EXPECT_EQ(floats(sampler.output)[4 * i + k], i == k + 1 ? 1 : 0);
  }
  SequencePlayer many(mesh, plane.mesh(), true);
  for (std::size_t i = 0; i < 700; ++i) many.add(i, Sites(mesh), plane);
  EXPECT_LE(many.write_glb(folder / "many.glb"), 250u);
  EXPECT_LT(std::filesystem::file_size(folder / "many.glb"), 60e6);
}

// One case for all models, so that the validator is installed and started once.
TEST(Glb, PassesTheKhronosValidator) {
  const TemporaryFolder folder;
  std::string files;
  const auto add = [&](const std::string& name, const Mesh& mesh, const AtlasOptions& atlas,
                       const Field& field, const PictureOptions& options = {}) {
    const Surface surface(mesh, atlas);
    write_glb(folder / name, surface, map_of(surface, field), at_vertices(mesh, field), options);
    files += " " + (folder / name).string();
  };
  const Field linear = [](const Vec3& p) { return p[0] + p[1]; };
  Mesh flawed = ring(8);
  flawed.triangles.push_back({0, 0, 1});            // repeated corner
  flawed.triangles.push_back(flawed.triangles[0]);  // duplicate
  flawed.positions.push_back(flawed.positions[0]);  // no area, three vertices
  flawed.triangles.push_back({0, 1, static_cast<std::uint32_t>(flawed.positions.size() - 1)});
  flawed.positions.push_back({9, 9, 9});  // of no face

  add("charts.glb", ring(16), {.resolution = 256}, linear);
  add("unlit.glb", ring(16), {.resolution = 256}, linear, {.up = UpAxis::z, .unlit = true});
  add("triangles.glb", ring(16), {.kind = AtlasKind::triangles, .resolution = 512}, linear, {.units = "in"});
  add("flawed.glb", flawed, {.resolution = 256}, linear);
  add("far.glb", ring(8, 1, {1e9, 1e9, -1e9}), {.resolution = 256}, linear, {.units = "mm"});
  add("huge.glb", ring(8, 1e30), {.resolution = 256}, linear);
  add("tiny.glb", ring(8, 1e-30), {.resolution = 256}, linear, {.units = "um"});
  add("empty.glb", ring(8), {.resolution = 256}, [](const Vec3&) { return std::nan(""); });
  add("partly.glb", ring(8), {.resolution = 256}, [](const Vec3& p) { return p[2] > 0 ? 1 : std::nan(""); });
  add("single.glb", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}}, {.resolution = 16}, linear);

  const auto animate = [&](const std::string& name, const Mesh& mesh, bool both, std::size_t frames,
                           const PlayerOptions& options) {
    const Sites still(ring(6, 1, {0, 0, 2}));
    SequencePlayer player(mesh, still.mesh(), both);
    for (std::size_t i = 0; i < frames; ++i)
      player.add(2 * i, Sites(moved(mesh, {0, 0, 0.01 * static_cast<double>(i)})), still);
    player.write_glb(folder / name, options);
    files += " " + (folder / name).string();
  };
  animate("animation.glb", ring(16), true, 9, {.units = "mm", .up = UpAxis::z});
  animate("one_body.glb", ring(16), false, 3, {.colors = {.tolerance = 0.5}});
  animate("one_frame.glb", ring(16), false, 1, {});
  animate("far_away.glb", ring(8, 1, {1e6, 1e6, -1e6}), true, 3, {});
  animate("long.glb", cube(), true, 600, {});

  const std::string validate = "cd '" SDM_VALIDATOR_FOLDER "' && node '" SDM_VALIDATOR_SCRIPT "'" + files;
  EXPECT_EQ(std::system(validate.c_str()), 0) << "npm is needed to install the validator";
}

}  // namespace
}  // namespace sdm::test
