// The channels of `sdm bake` that are no textures of materials, and several samples a texel.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/bake_files.h>
#include <sdm/closest_points.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/owned_texels.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/srgb.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

struct ReadExr {
  std::size_t width = 0, height = 0;
  std::map<std::string, std::vector<float>> values;
  std::map<std::string, std::vector<std::uint32_t>> numbers;
};

/// By OpenEXR's C++ interface, which sdm does not use.
ReadExr read(const std::string& file) {
  Imf::InputFile exr(file.c_str());
  const auto size = exr.header().dataWindow().max;
  ReadExr result{.width = static_cast<std::size_t>(size.x) + 1,
                 .height = static_cast<std::size_t>(size.y) + 1,
                 .values = {},
                 .numbers = {}};
  Imf::FrameBuffer frame;
  for (auto channel = exr.header().channels().begin(); channel != exr.header().channels().end(); ++channel) {
    const bool whole = channel.channel().type == Imf::UINT;
    char* to = nullptr;
    if (whole) {
      auto& plane = result.numbers[channel.name()];
      plane.resize(result.width * result.height);
      to = reinterpret_cast<char*>(plane.data());
    } else {
      auto& plane = result.values[channel.name()];
      plane.resize(result.width * result.height);
      to = reinterpret_cast<char*>(plane.data());
    }
    frame.insert(channel.name(), Imf::Slice(channel.channel().type, to, 4, 4 * result.width));
  }
  exr.setFrameBuffer(frame);
  exr.readPixels(0, size.y);
  return result;
}

/// A bumpy ball, with two materials, around a cube whose faces have texture coordinates of their own.
struct BakedChannels : ::testing::Test {
  TemporaryFolder folder;
  std::string high = folder / "high.obj", low = folder / "low.obj", out = folder / "out";
  Mesh ball = sphere(3), box = with_own_uvs(cube(0.6), 64);

  void SetUp() override {
    for (Vec3& p : ball.positions) p = (1 + 0.05 * std::sin(7 * p[0]) * std::cos(5 * p[1])) * p;
    std::ofstream(folder / "high.mtl") << "newmtl red\nKd 0.5 0.25 0.25\nnewmtl blue\nKd 0.25 0.25 0.5\n";
    std::ostringstream text;
    text.precision(17);
    text << "mtllib high.mtl\n";
    for (const Vec3& p : ball.positions) text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (std::size_t f = 0; f < ball.triangles.size(); ++f) {
      text << (is_red(f) ? "usemtl red\nf" : "usemtl blue\nf");
      for (const std::uint32_t v : ball.triangles[f]) text << ' ' << v + 1;
      text << '\n';
    }
    std::ofstream(high) << text.str();
    text.str("");
    for (const Vec3& p : box.positions) text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& uvs : box.corner_uvs)
      for (const Vec2& uv : uvs) text << "vt " << uv[0] << ' ' << uv[1] << '\n';
    for (std::size_t f = 0; f < box.triangles.size(); ++f) {
      text << 'f';
      for (std::size_t k = 0; k < 3; ++k) text << ' ' << box.triangles[f][k] + 1 << '/' << 3 * f + k + 1;
      text << '\n';
    }
    std::ofstream(low) << text.str();
  }
  static bool is_red(std::size_t face) { return face % 3 == 0; }

  [[nodiscard]] Outcome run(std::vector<std::string> more, const std::string& resolution = "64") const {
    std::vector<std::string> arguments{"bake", high, low, "-o", out, "--resolution", resolution, "--no-page"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
  Json report(const std::vector<std::string>& more, const std::string& resolution = "64") const {
    const Outcome outcome = run(more, resolution);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json::parse(std::ifstream(out + "/report.json"));
  }
};

// Against the functions of the library, of the meshes that the files have.
TEST_F(BakedChannels, LengthsAndPositionsAreThoseOfTheLibrary) {
  const Json json =
      report({"--channels", "displacement,position,thickness", "--match", "ray", "--units", "mm"});
  const Surface surface(read_mesh(low), {.kind = AtlasKind::uv, .resolution = 64});
  const Sites sites(read_mesh(high));
  const TexelMatches matches = match_texels(surface, sites, {.method = MatchMethod::ray});
  const auto displacements = matched_displacements(surface, sites, matches, smooth_normals(surface.mesh()));
  const auto positions = matched_positions(surface, sites, matches);
  const auto thickness = matched_thickness(surface, sites, matches, ThicknessMethod::ball);
  const ReadExr d = read(out + "/displacement.exr"), p = read(out + "/position.exr"),
                t = read(out + "/thickness.exr");
  ASSERT_EQ(d.width, 64u);
  ASSERT_EQ(d.height, 64u);
  const Image picture = read_image(out + "/displacement.png"), walls = read_image(out + "/thickness.png");
  ASSERT_EQ(picture.bits, 16u);
  const double lo = json["textures"]["displacement"]["picture"]["lower"],
               hi = json["textures"]["displacement"]["picture"]["upper"],
               most = json["textures"]["thickness"]["picture"]["upper"];
  EXPECT_EQ(lo, -hi);
  EXPECT_EQ(json["textures"]["thickness"]["picture"]["lower"], 0);
  double largest = 0;
  for (const std::uint32_t i : test::owned_texels(surface)) {
    ASSERT_EQ(d.values.at("displacement.D")[i], displacements[i]) << i;
    ASSERT_EQ(d.values.at("coverage.A")[i], 1);
    ASSERT_EQ(t.values.at("thickness.D")[i], thickness[i]);
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(p.values.at(std::string("position.") + "XYZ"[k])[i], positions[3 * std::size_t{i} + k]);
    ASSERT_NEAR(lo + (hi - lo) * picture.value(i % 64, i / 64, 0), displacements[i], (hi - lo) / 65535);
    ASSERT_NEAR(most * walls.value(i % 64, i / 64, 0), thickness[i], most / 65535);
    largest = std::max(largest, double{std::abs(displacements[i])});
  }
  EXPECT_GT(largest, 0.2);
  EXPECT_FLOAT_EQ(static_cast<float>(hi), static_cast<float>(largest));
  // What no face owns is filled, and not covered.
  std::size_t free = 0;
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    ASSERT_TRUE(std::isfinite(d.values.at("displacement.D")[i]));
    free += d.values.at("coverage.A")[i] == 0;
  }
  EXPECT_EQ(free, 64 * 64 - surface.owned_texels());
}

TEST_F(BakedChannels, NumbersAreThoseOfTheClosestFace) {
  const Json json = report({"--channels", "face,material"});
  EXPECT_EQ(json["textures"]["material"]["names"], (Json{"red", "blue"}));
  const Surface surface(read_mesh(low), {.kind = AtlasKind::uv, .resolution = 64});
  const Sites sites(read_mesh(high));
  const auto faces = read(out + "/face.exr").numbers.at("face.id"),
             materials = read(out + "/material.exr").numbers.at("material.id");
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (surface.map_faces()[i] == kNone) {
      ASSERT_EQ(faces[i], kNone);
      ASSERT_EQ(materials[i], kNone);
      continue;
    }
    const Vec3 q = surface.texel_point(static_cast<std::uint32_t>(i));
    const ClosestPoint closest = closest_points(sites, std::vector{q})[0];
    const auto& [a, b, c] = ball.triangles[faces[i]];
    const Mesh face{.positions = {ball.positions[a], ball.positions[b], ball.positions[c]},
                    .triangles = {{0, 1, 2}},
                    .corner_uvs = {}};
    ASSERT_NEAR(norm(closest_points(Sites(face), std::vector{q})[0].point - q), norm(closest.point - q),
                1e-6);
    ASSERT_EQ(materials[i], is_red(faces[i]) ? 0u : 1u);
  }
}

TEST_F(BakedChannels, ObjectNormalsHave16BitsAndOcclusionIsInTheModel) {
  const Json json = report({"--channels", "object_normal,ambient_occlusion", "--occlusion-rays", "16"});
  EXPECT_EQ(json["textures"]["ambient_occlusion"]["in_model"], true);
  const Image normals = read_image(out + "/object_normal.png");
  ASSERT_EQ(normals.bits, 16u);
  const Surface surface(read_mesh(low), {.kind = AtlasKind::uv, .resolution = 64});
  const Sites sites(read_mesh(high));
  const TexelMatches matches = match_texels(surface, sites, {.method = MatchMethod::closest});
  const auto expected = matched_normals(surface, sites, matches, smooth_normals(sites.mesh()));
  for (const std::uint32_t i : test::owned_texels(surface))
    for (std::uint32_t k = 0; k < 3; ++k)
      ASSERT_NEAR(2 * normals.value(i % 64, i / 64, k) - 1, expected[3 * std::size_t{i} + k], 2.0 / 65535);
  const MeshFile model = read_mesh_file(out + "/baked.glb", {.attributes = true});
  ASSERT_EQ(model.materials.size(), 1u);
  ASSERT_NE(model.materials[0].occlusion_texture.texture, kNone);
  EXPECT_EQ(decode_image(model.textures[model.materials[0].occlusion_texture.texture].bytes).bytes,
            read_image(out + "/ambient_occlusion.png").bytes);
  // A ball that is nearly convex has little to occlude it.
  const Image occlusion = read_image(out + "/ambient_occlusion.png");
  EXPECT_EQ(occlusion.components, 1u);
  for (const std::uint32_t i : test::owned_texels(surface))
    ASSERT_GT(occlusion.value(i % 64, i / 64, 0), 0.6);
}

TEST_F(BakedChannels, WhatCannotBeBakedIsSaid) {
  std::ofstream(high, std::ios::app) << "f 1 2 3\n";  // an edge of three faces
  const Outcome thickness = run({"--channels", "thickness"});
  EXPECT_EQ(thickness.code, 1);
  EXPECT_THAT(thickness.err, HasSubstr(high + ": a mesh that is open has no thickness"));
  EXPECT_FALSE(std::filesystem::exists(out));
  std::filesystem::remove(folder / "high.mtl");
  const Outcome material = run({"--channels", "material"});
  EXPECT_EQ(material.code, 1);
  EXPECT_THAT(material.err, HasSubstr(high + " has no materials, so the channel `material` cannot be baked"));
  EXPECT_THAT(run({}).err, HasSubstr("nothing to bake but its shape, as --channels normal"));
  EXPECT_EQ(run({"--channels", "displacement"}).code, 0);
}

// Several samples a texel are the texels of a finer texture, of which each is the mean.
TEST_F(BakedChannels, SamplesAreAveragedInLinearLight) {
  const std::string channels = "base_color,position,face";
  const Json fine_report = report({"--channels", channels}, "128");
  const Image fine = read_image(out + "/base_color.png");
  const ReadExr fine_positions = read(out + "/position.exr"), fine_faces = read(out + "/face.exr");
  const Json coarse_report = report({"--channels", channels, "--samples", "16"}, "32");
  EXPECT_EQ(coarse_report["atlas"]["resolution"], 32);
  EXPECT_EQ(coarse_report["atlas"]["samples"], 16);
  EXPECT_EQ(coarse_report["atlas"]["texels"], fine_report["atlas"]["texels"]);
  EXPECT_EQ(coarse_report["texels"], fine_report["texels"]);
  const Image coarse = read_image(out + "/base_color.png");
  const ReadExr positions = read(out + "/position.exr"), faces = read(out + "/face.exr");
  ASSERT_EQ(coarse.width, 32u);
  std::size_t mixed = 0;
  for (std::uint32_t y = 0; y < 32; ++y)
    for (std::uint32_t x = 0; x < 32; ++x) {
      const std::size_t texel = std::size_t{y} * 32 + x;
      double light[3]{}, place = 0;
      std::map<std::uint32_t, int> counts;
      int samples = 0;
      for (std::uint32_t i = 4 * y; i < 4 * y + 4; ++i)
        for (std::uint32_t j = 4 * x; j < 4 * x + 4; ++j) {
          if (fine_positions.values.at("coverage.A")[i * 128 + j] == 0) continue;
          ++samples;
          ++counts[fine_faces.numbers.at("face.id")[i * 128 + j]];
          place += fine_positions.values.at("position.Y")[i * 128 + j];
          for (std::uint32_t k = 0; k < 3; ++k) light[k] += linear_of(fine.value(j, i, k));
        }
      ASSERT_FLOAT_EQ(positions.values.at("coverage.A")[texel], static_cast<float>(samples / 16.0));
      if (samples == 0) continue;
      for (std::uint32_t k = 0; k < 3; ++k)
        ASSERT_NEAR(255 * coarse.value(x, y, k), 255 * srgb_of(light[k] / samples), 1.01);
      ASSERT_NEAR(positions.values.at("position.Y")[texel], place / samples, 1e-6);
      int most = 0;
      for (const auto& [face, count] : counts) most = std::max(most, count);
      ASSERT_EQ(counts[faces.numbers.at("face.id")[texel]], most);
      mixed += std::abs(255 * coarse.value(x, y, 0) - 255 * fine.value(4 * x, 4 * y, 0)) > 3;
    }
  EXPECT_GT(mixed, 50u);
  EXPECT_THAT(run({"--samples", "5"}).err,
              HasSubstr("--samples is 5: it must be a whole number from 1 to 64 that is a square"));
  const Outcome many = run({"--samples", "64"}, "8192");
  EXPECT_EQ(many.code, 2);
  EXPECT_THAT(many.err, HasSubstr("64 samples a texel are more than 32768 along a side of the texture"));
}

}  // namespace
}  // namespace sdm::test
