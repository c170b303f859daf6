// `sdm bake`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/bake_files.h>
#include <sdm/closest_points.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::json;

void write_text(const std::filesystem::path& file, std::string_view text) {
  std::ofstream(file, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
}

/// With texture coordinates, if it has them.
std::string obj_of(const Mesh& mesh, const std::string& first_lines = "") {
  std::ostringstream out;
  out.precision(17);
  out << first_lines;
  for (const Vec3& p : mesh.positions) out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const auto& uvs : mesh.corner_uvs)
    for (const Vec2& uv : uvs) out << "vt " << uv[0] << ' ' << uv[1] << '\n';
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    out << 'f';
    for (std::size_t k = 0; k < 3; ++k) {
      out << ' ' << mesh.triangles[f][k] + 1;
      if (!mesh.corner_uvs.empty()) out << '/' << 3 * f + k + 1;
    }
    out << '\n';
  }
  return out.str();
}

/// Red grows to the right, green to the top, in sRGB.
Image gradient() {
  Image image{.width = 256, .height = 256, .components = 3, .bits = 8, .bytes = {}};
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      for (const int value : {x, 255 - y, 128}) image.bytes.push_back(static_cast<std::uint8_t>(value));
  return image;
}

/// The tangents of the corners of a model of one primitive, which readers of meshes leave out.
std::vector<std::array<float, 4>> corner_tangents(const std::string& glb) {
  std::ifstream file(glb, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes[at], sizeof(value));
    return value;
  };
  const std::uint32_t json_size = number(12);
  const Json model = Json::parse(bytes.substr(20, json_size));
  const std::size_t binary = 20 + json_size + 8;
  const auto begin_of = [&](const Json& accessor) {
    const Json& view =
        model["bufferViews"]
             [model["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
    return binary + view.value("byteOffset", std::size_t{0});
  };
  const Json& primitive = model["meshes"][0]["primitives"][0];
  const std::size_t indices = begin_of(primitive["indices"]),
                    tangents = begin_of(primitive["attributes"]["TANGENT"]);
  std::vector<std::array<float, 4>> result(
      model["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>());
  for (std::size_t i = 0; i < result.size(); ++i)
    std::memcpy(result[i].data(), &bytes[tangents + 16 * number(indices + 4 * i)], 16);
  return result;
}

struct BakeCommandTest : ::testing::Test {
  TemporaryFolder folder;
  std::string high = folder / "high.obj", low = folder / "low.obj", out = folder / "out";

  void SetUp() override {
    const std::vector<char> png = encode_png(gradient());
    write_text(folder / "picture.png", {png.data(), png.size()});
    write_text(folder / "high.mtl", "newmtl painted\nPm 0.25\nPr 0.5\nmap_Kd picture.png\n");
    write_text(high, obj_of(height_field(40), "mtllib high.mtl\nusemtl painted\n"));
    Mesh coarse = height_field(8);
    coarse.corner_uvs.clear();
    write_text(low, obj_of(coarse));
  }
  [[nodiscard]] Outcome run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"bake", high, low, "-o", out, "--resolution", "128"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
  /// But for the page, which not all builds have.
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(out))
      if (entry.path().filename() != "report.html" && entry.path().filename() != ".sdm-files.json")
        names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }
};

// The model is read again: at the corners of its faces its picture has the colour of the place in HIGH's.
TEST_F(BakeCommandTest, ModelsLookLikeTheDetailedMesh) {
  const Outcome outcome = run();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("baked.glb", "base_color.png", "report.json"));
  EXPECT_THAT(outcome.out, HasSubstr("base_color, 128 x 128 texels"));
  const MeshFile model = read_mesh_file(out + "/baked.glb", {.attributes = true});
  EXPECT_THAT(model.notes, IsEmpty());
  ASSERT_EQ(model.materials.size(), 1u);
  const Material& material = model.materials[0];
  EXPECT_EQ(material.metallic, 0.25f);
  EXPECT_EQ(material.roughness, 0.5f);
  EXPECT_EQ(material.base_color[0], 1);
  ASSERT_EQ(model.textures.size(), 1u);
  const Image image = decode_image(model.textures[0].bytes);
  EXPECT_EQ(image.bytes, read_image(out + "/base_color.png").bytes);
  ASSERT_EQ(image.width, 128u);
  for (std::size_t f = 0; f < model.mesh.triangles.size(); ++f) {
    Vec3 p{};
    Vec2 uv{};
    for (std::size_t k = 0; k < 3; ++k) {
      p = p + (1.0 / 3) * model.mesh.positions[model.mesh.triangles[f][k]];
      uv = uv + (1.0 / 3) * model.mesh.corner_uvs[f][k];
    }
    const auto x = static_cast<std::uint32_t>(uv[0] * 128), y = static_cast<std::uint32_t>((1 - uv[1]) * 128);
    // Within a texel, and what the coarse mesh is off.
    EXPECT_NEAR(image.value(x, y, 0), p[0], 0.03) << f;
    EXPECT_NEAR(image.value(x, y, 1), p[1], 0.03) << f;
    EXPECT_NEAR(image.value(x, y, 2), 128 / 255.0, 0.002) << f;
  }
}

// Once, the mesh of HIGH had moved into its sites before it was compared with LOW.
TEST_F(BakeCommandTest, NotesThatUnitsDiffer) {
  const Outcome outcome = run({"--transform-low", "scale:1000", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(Json::parse(outcome.out)["notes"].dump(),
              HasSubstr("times the other; millimetres and metres?"));
}

TEST_F(BakeCommandTest, ReportsStateWhatWasFound) {
  const Outcome outcome = run({"--max-distance", "0.01", "--json", "--units", "mm"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report, Json::parse(std::ifstream(out + "/report.json")));
  EXPECT_EQ(report["high"]["triangles"], 3200);
  EXPECT_EQ(report["low"]["triangles"], 128);
  EXPECT_EQ(report["atlas"]["kind"], "charts");
  EXPECT_EQ(report["textures"]["base_color"]["file"], "base_color.png");
  EXPECT_EQ(report["textures"]["base_color"]["values"], "sRGB");
  const Json& texels = report["texels"];
  EXPECT_GT(texels["too_far"], 0);
  EXPECT_GT(texels["closest"], texels["too_far"]);
  EXPECT_EQ(texels["closest"].get<int>() + texels["too_far"].get<int>(),
            report["atlas"]["texels"].get<int>());
  EXPECT_EQ(report["max_distance"], 0.01);
  EXPECT_TRUE(report["facing"].is_null());
  const Json facing = Json::parse(run({"--facing", "--json"}).out);
  EXPECT_EQ(facing["facing"], 90);
  EXPECT_EQ(facing["texels"]["facing"], facing["atlas"]["texels"]);
}

TEST_F(BakeCommandTest, ChannelsAreThoseThatDifferOrThatAreAskedFor) {
  write_text(folder / "high.mtl",
             "newmtl painted\nPm 0.25\nPr 0.5\nmap_Kd picture.png\nmap_Ke picture.png\n");
  ASSERT_EQ(run().code, 0);
  EXPECT_THAT(files(), ElementsAre("baked.glb", "base_color.png", "emissive.png", "report.json"));
  ASSERT_EQ(run({"--channels", "metallic_roughness,occlusion"}).code, 0);
  EXPECT_THAT(files(), ElementsAre("baked.glb", "metallic_roughness.png", "occlusion.png", "report.json"));
  const Image image = read_image(out + "/metallic_roughness.png");
  EXPECT_EQ(std::vector(image.bytes.begin(), image.bytes.begin() + 3),
            (std::vector<std::uint8_t>{255, 128, 64}));
  const Outcome unknown = run({"--channels", "gloss"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(
      unknown.err,
      HasSubstr("--channels is gloss: it must be one or more of base_color, metallic_roughness, occlusion, "
                "emissive, normal, "
                "object_normal, displacement, position, ambient_occlusion, thickness, face, material"));
  const Outcome with_page = run(), without = run({"--no-page"});
  EXPECT_EQ(std::string::npos != with_page.out.find("report.html"), can_write_html());
  EXPECT_THAT(without.out, Not(HasSubstr("report.html")));
  EXPECT_FALSE(std::filesystem::exists(out + "/report.html"));  // nor that of the run before
}

TEST_F(BakeCommandTest, RaysAreUsedWithinTheCage) {
  const auto report = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--json", "--match", "ray"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json::parse(outcome.out);
  };
  const Json all = report({}), few = report({"--cage", "0.001", "--facing", "80"});
  EXPECT_EQ(all["match"], "ray");
  EXPECT_EQ(all["facing"], 90);
  EXPECT_TRUE(all["cage"].is_null());
  EXPECT_GT(all["texels"]["ray"].get<double>(), 0.9 * all["atlas"]["texels"].get<double>());
  EXPECT_EQ(few["facing"], 80);
  EXPECT_EQ(few["cage"], 0.001);
  EXPECT_LT(few["texels"]["ray"].get<int>(), all["texels"]["ray"].get<int>());
  EXPECT_EQ(few["texels"]["ray"].get<int>() + few["texels"]["facing"].get<int>(),
            few["atlas"]["texels"].get<int>());
  EXPECT_THAT(run({"--match", "ray"}).out, HasSubstr("of them by a ray along the normal of LOW"));
  EXPECT_EQ(run({"--cage", "1"}).code, 2);
  EXPECT_EQ(run({"--match", "closest", "--facing"}).code, 2);
  EXPECT_EQ(run({"--match", "nearest"}).code, 2);
}

// The model is read as a renderer reads it: the colour of its normal map, in its normals and tangents.
TEST_F(BakeCommandTest, NormalMapsShadeTheCoarseMeshAsTheDetailedOne) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  write_text(high, obj_of(height_field(40)));  // nothing but a shape
  ASSERT_EQ(run({"--channels", "normal", "--match", "ray"}).code, 0);
  EXPECT_THAT(files(), ElementsAre("baked.glb", "normal.png", "report.json"));
  const MeshFile model = read_mesh_file(out + "/baked.glb", {.attributes = true});
  const auto found = std::ranges::find(model.attributes, "normal", &MeshAttribute::name);
  ASSERT_NE(found, model.attributes.end());
  const MeshAttribute& normals = *found;
  const auto tangents = corner_tangents(out + "/baked.glb");
  ASSERT_EQ(tangents.size(), 3 * model.mesh.triangles.size());
  const Image image = read_image(out + "/normal.png");
  const Mesh detailed = height_field(40);
  const MeshAttribute wanted = smooth_normals(detailed);
  const Sites sites(detailed);
  std::size_t compared = 0;
  double sum = 0;
  for (std::size_t f = 0; f < model.mesh.triangles.size(); ++f) {
    Vec3 p{}, n{}, t{};
    Vec2 uv{};
    double w = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const normal = &normals.values[3 * (*normals.rows)[f][k]];
      const auto& tangent = tangents[3 * f + k];
      p = p + (1.0 / 3) * model.mesh.positions[model.mesh.triangles[f][k]];
      n = n + (1.0 / 3) * Vec3{normal[0], normal[1], normal[2]};
      t = t + (1.0 / 3) * Vec3{tangent[0], tangent[1], tangent[2]};
      uv = uv + (1.0 / 3) * model.mesh.corner_uvs[f][k];
      w = tangent[3];
    }
    const auto x = static_cast<std::uint32_t>(uv[0] * 128), y = static_cast<std::uint32_t>((1 - uv[1]) * 128);
    Vec3 stored{};
    for (std::uint32_t k = 0; k < 3; ++k) stored[k] = 2.0 * image.value(x, y, k) - 1;
    const Vec3 read = normalized(stored[0] * t + stored[1] * (w * cross(n, t)) + stored[2] * n);
    // The normal of the detailed mesh along that of the coarse one, about a texel beside.
    const ClosestPoint near = closest_points(sites, std::vector{p})[0];
    Vec3 normal{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const at = &wanted.values[3 * (*wanted.rows)[near.face][k]];
      normal = normal + Vec3{at[0], at[1], at[2]};
    }
    ++compared;
    sum += dot(read, normalized(normal));
    EXPECT_GT(dot(read, normalized(normal)), 0.97) << f;
  }
  EXPECT_EQ(compared, 128u);
  EXPECT_GT(sum / static_cast<double>(compared), 0.995);
}

// Regression: normal textures of HIGH were left out. On a mesh with the same texture coordinates, what is
// baked is the texture itself.
TEST_F(BakeCommandTest, NormalTexturesBendTheNormals) {
  if (!has_tangents()) GTEST_SKIP() << "this build has no MikkTSpace";
  constexpr std::uint32_t kSize = 64;
  Image picture{.width = kSize, .height = kSize, .components = 3, .bytes = {}};
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const double turn = 2 * std::numbers::pi / kSize;
      const Vec3 n = normalized(Vec3{0.4 * std::sin(turn * x), 0.3 * std::cos(2 * turn * y), 1});
      for (const double c : n)
        picture.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * (c + 1) / 2)));
    }
  const Mesh mesh = torus(64, 48);
  std::vector<Material> materials(1);
  materials[0].normal_texture.texture = 0;
  const std::vector<TextureFile> textures{{"bumps", encode_png(picture)}};
  const std::vector<std::uint32_t> face_materials(mesh.triangles.size(), 0);
  const std::string bumpy = folder / "bumpy.glb";
  write_mesh(bumpy, mesh, {.materials = materials, .textures = textures, .face_materials = face_materials});
  const std::string plain = folder / "plain.glb";
  write_mesh(plain, mesh);
  for (const char* samples : {"1", "4"}) {
    const Outcome outcome = run_sdm({"bake", bumpy, plain, "-o", out, "--channels", "normal", "--resolution",
                                     std::to_string(kSize), "--samples", samples, "--no-page", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["notes"], Json::array());
    const Image baked = read_image(std::filesystem::path(out) / "normal.png");
    ASSERT_EQ(baked.width, kSize);
    double sum = 0;
    for (std::size_t i = 0; i < picture.bytes.size(); ++i) {
      const double error = std::abs(double{1} * baked.bytes[i] - picture.bytes[i]);
      EXPECT_LE(error, 6) << i / 3 % kSize << ", " << i / 3 / kSize;
      sum += error;
    }
    EXPECT_LT(sum / static_cast<double>(picture.bytes.size()), 1);
  }
}

TEST_F(BakeCommandTest, UvsAreUsedIfTheyAreUsable) {
  const auto kind = [&](const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const Json report = Json::parse(outcome.out);
    return report["atlas"]["kind"].get<std::string>() + report["notes"].dump();
  };
  const Mesh with_uvs = height_field(8);
  write_text(low, obj_of(with_uvs));
  EXPECT_EQ(kind(), "uv[]");
  Mesh beyond = with_uvs, twice = with_uvs;
  for (auto& uvs : beyond.corner_uvs)
    for (Vec2& uv : uvs) uv = 2.0 * uv;
  write_text(low, obj_of(beyond));
  EXPECT_THAT(kind(), HasSubstr("charts[\"" + low + ": its UVs leave [0, 1], so it got an atlas of charts"));
  Mesh nowhere = with_uvs;
  nowhere.corner_uvs.assign(nowhere.triangles.size(), {});
  write_text(low, obj_of(nowhere));
  EXPECT_THAT(kind(), HasSubstr("charts[\"" + low + ": its UVs are all the same, so it got an atlas"));
  // Regression: on the border, it was said to leave the square; then, one face without area in the texture
  // discarded the layout.
  Mesh border = with_uvs;
  border.corner_uvs[0] = {{{1, 0}, {1, 0}, {1, 1}}};
  write_text(low, obj_of(border));
  EXPECT_EQ(kind(), "uv[\"" + low +
                        ": 1 of 128 faces has no area in the UVs, so no texel: the texture shows " +
                        "on them what lies at their UVs\"]");
  EXPECT_THAT(kind({"--atlas", "uv"}), HasSubstr("uv[\"" + low + ": 1 of 128 faces has no area"));
  for (std::size_t f = twice.corner_uvs.size() / 2; f < twice.corner_uvs.size(); ++f)
    for (Vec2& uv : twice.corner_uvs[f]) uv[1] -= 0.5;
  write_text(low, obj_of(twice));
  EXPECT_THAT(kind(), HasSubstr("charts[\"" + low + ": faces overlap in its UVs, so it got"));
  EXPECT_THAT(kind({"--atlas", "uv"}), HasSubstr("uv[\"" + low + ": "));
}

TEST_F(BakeCommandTest, FailuresAreOneSentenceAndLeaveNothing) {
  const auto error = [&](const std::vector<std::string>& more) {
    const Outcome outcome = run(more);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_FALSE(std::filesystem::exists(out));
    return outcome.err;
  };
  EXPECT_THAT(
      error({"--transform-low", "translate:9:0:0", "--max-distance", "1"}),
      HasSubstr("is close enough to a texel (--max-distance 1) of " + low + ": nothing can be baked"));
  write_text(high, obj_of(height_field(8)));
  EXPECT_THAT(error({}), HasSubstr(high + " has neither materials nor colours of vertices"));
  write_text(high, obj_of(height_field(8), "mtllib none.mtl\n"));
  EXPECT_THAT(error({}), HasSubstr("has neither materials"));
}

TEST_F(BakeCommandTest, TexturesThatAreMissingOrDamagedAreNotes) {
  std::filesystem::remove(folder / "picture.png");
  const Outcome missing = run();
  EXPECT_EQ(missing.code, 0) << missing.err;
  EXPECT_THAT(missing.out, HasSubstr("map_Kd of the material painted is left out"));
  write_text(folder / "picture.png", "\x89PNG\r\n\x1a\nand so on");
  const Outcome damaged = run();
  EXPECT_EQ(damaged.code, 0) << damaged.err;
  EXPECT_THAT(damaged.out, HasSubstr("the texture picture.png is left out"));
  EXPECT_THAT(damaged.out, HasSubstr("base_color"));
}

TEST_F(BakeCommandTest, TexturesThatNoChannelNeedsAreNotDecoded) {
  write_text(folder / "damaged.png", "\x89PNG\r\n\x1a\nand so on");
  write_text(folder / "high.mtl",
             "newmtl painted\nmap_Kd picture.png\nnorm damaged.png\nnewmtl unused\nmap_Kd damaged.png\n");
  EXPECT_THAT(run().out, Not(HasSubstr("left out")));
  write_text(folder / "high.mtl", "newmtl painted\nmap_Kd picture.png\nmap_Ke damaged.png\n");
  EXPECT_THAT(run({"--channels", "base_color"}).out, Not(HasSubstr("left out")));
  EXPECT_THAT(run().out, HasSubstr("the texture damaged.png is left out"));
}

/// The checksum of PNG's chunks.
std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

/// A PNG file that says it has so many pixels a side.
std::string png_of_side(std::uint32_t side) {
  const std::vector<char> png = encode_png(gradient());
  std::string file(png.begin(), png.end());
  const auto set = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t k = 0; k < 4; ++k) file[at + k] = static_cast<char>(value >> (24 - 8 * k));
  };
  set(16, side);
  set(20, side);
  set(29, crc_of(std::string_view(file).substr(12, 17)));
  return file;
}

// Once, such a texture was left out with a note, as a damaged one is.
TEST_F(BakeCommandTest, TexturesThatMemoryDoesNotSufficeForAreErrors) {
  write_text(folder / "picture.png", png_of_side(11'000));  // of three bytes each: 363 MB
  const Outcome outcome = run_sdm({"bake", high, low, "-o", out}, {.memory = std::uint64_t{352} << 20});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("the texture picture.png: a picture needs 0.363 GB of memory"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

// What the heads of pictures say is enough: none is decoded. More bytes may have more pixels.
TEST_F(BakeCommandTest, TexturesOfTooManyPixelsForTheirFilesAreRefused) {
  const std::string file = png_of_side(16'384);
  write_text(folder / "picture.png", file);
  const Outcome refused = run();
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err,
              HasSubstr(high + ": the texture picture.png: its 268435456 pixels are too many in " +
                        std::to_string(file.size()) + " bytes"));
  EXPECT_FALSE(std::filesystem::exists(out));
  write_text(folder / "picture.png", file + std::string(std::size_t{1} << 22, ' '));
  EXPECT_THAT(run().out, HasSubstr("the texture picture.png is left out"));  // the rest is not there
}

// Colours of vertices, as of scans: in PLY sRGB.
TEST_F(BakeCommandTest, ColorsOfVerticesAreBaked) {
  std::ostringstream ply;
  const Mesh mesh = height_field(10);
  ply << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : mesh.positions) ply << p[0] << ' ' << p[1] << ' ' << p[2] << " 200 100 50\n";
  for (const Triangle& t : mesh.triangles) ply << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  high = folder / "high.ply";
  write_text(high, ply.str());
  const Outcome outcome = run();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Image image = read_image(out + "/base_color.png");
  for (std::size_t i = 0; i < image.bytes.size(); ++i)
    ASSERT_EQ(image.bytes[i], (std::array{200, 100, 50})[i % 3]) << i;
}

TEST_F(BakeCommandTest, ModelsPassTheKhronosValidator) {
  write_text(folder / "high.mtl", "newmtl painted\nd 0.5\nPm 0.25\nmap_Kd picture.png\nmap_Ke picture.png\n");
  std::string models;
  for (const char* channels : {"base_color,emissive", "metallic_roughness,occlusion",
                               has_tangents() ? "base_color,normal" : "occlusion"}) {
    out = folder / channels;
    ASSERT_EQ(run({"--channels", channels, "--units", "mm", "--up", "z"}).code, 0);
    models += " '" + out + "/baked.glb'";
  }
  const std::string validate = "cd '" SDM_VALIDATOR_FOLDER "' && node '" SDM_VALIDATOR_SCRIPT "'" + models;
  EXPECT_EQ(std::system(validate.c_str()), 0) << "npm is needed to install the validator";
}

}  // namespace
}  // namespace sdm::test
