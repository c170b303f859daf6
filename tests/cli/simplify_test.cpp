// `sdm simplify`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/bake_files.h>
#include <sdm/hausdorff.h>
#include <sdm/mesh_files.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

struct SimplifyRun : ::testing::Test {
  TemporaryFolder folder;
  Mesh mesh = sphere(4);
  std::string input = write_obj(folder / "sphere.obj", mesh);
  std::string out = folder / "low.ply";

  [[nodiscard]] Outcome run(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"simplify", input, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

TEST_F(SimplifyRun, KeepsTheLimitInTheFile) {
  for (const char* name : {"low.ply", "low.obj", "low.stl", "low.glb"}) {
    out = folder / name;
    const Outcome done = run({"--max-deviation", "0.02", "--json"});
    ASSERT_EQ(done.code, 0) << done.err;
    const Json json = Json::parse(done.out);
    const Json& level = json["levels"][0];
    const Mesh low = read_mesh(out);
    EXPECT_EQ(level["file"], out);
    EXPECT_EQ(level["triangles"], low.triangles.size());
    EXPECT_LT(low.triangles.size(), mesh.triangles.size() / 2);
    EXPECT_LE(level["deviation"]["upper"], 0.02);
    const SymmetricHausdorff truth = symmetric_hausdorff(Sites(read_mesh(input)), Sites(low));
    EXPECT_LE(truth.larger.distance.lower, level["deviation"]["upper"]) << name;
    EXPECT_GE(truth.larger.distance.upper, level["deviation"]["lower"]) << name;
    EXPECT_EQ(level["estimate"]["kind"], "estimate");
    EXPECT_GT(level["estimate"]["value"], 0);
    for (const char* step : {"import", "sites", "collapse", "deviation", "output"})
      EXPECT_GT(json["time_ms"][step], 0) << step;
  }
}

// The report is among the files that appear together, and fails before any of them does.
TEST_F(SimplifyRun, WithoutItsReportThereAreNoMeshes) {
  std::filesystem::create_directory(folder / "report.json");
  for (const std::string& report : {std::string(folder / "report.json"), input + "/report.json"}) {
    const Outcome done = run({"--triangles", "50%", "--lods", "1", "--report", report});
    EXPECT_EQ(done.code, 1) << report;
    EXPECT_NE(done.err, "");
    EXPECT_THAT(names_in(folder.path()), ElementsAre("report.json", "sphere.obj"));
  }
  const Outcome elsewhere = run({"--triangles", "50%", "--report", "/dev/stdout", "--quiet"});
  EXPECT_EQ(elsewhere.code, 0) << elsewhere.err;
  EXPECT_THAT(elsewhere.out, HasSubstr("\"levels\""));
}

TEST_F(SimplifyRun, WritesLevelsOfDetailAndTheReport) {
  const Outcome done =
      run({"--triangles", "50%", "--lods", "2", "--units", "mm", "--report", folder / "report.json"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(names_in(folder.path()),
              ElementsAre("low.ply", "low_lod1.ply", "low_lod2.ply", "report.json", "sphere.obj"));
  const Json json = Json::parse(contents(folder / "report.json"));
  EXPECT_EQ(json["max_triangles"], mesh.triangles.size() / 2);
  EXPECT_EQ(json["max_deviation"], nullptr);
  EXPECT_EQ(json["mesh"]["triangles"], mesh.triangles.size());
  ASSERT_EQ(json["levels"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& level = json["levels"][i];
    EXPECT_LE(level["triangles"], mesh.triangles.size() >> (i + 1));
    EXPECT_EQ(read_mesh(level["file"].get<std::string>()).triangles.size(), level["triangles"]);
    if (i == 0) continue;
    EXPECT_GE(level["deviation"]["upper"], json["levels"][i - 1]["deviation"]["lower"]);
  }
  EXPECT_THAT(done.out, HasSubstr("deviation  "));
  EXPECT_THAT(done.out, HasSubstr(" mm, of the collapses, no bound"));
}

// Regression: normals, colours, materials and names were lost.
TEST_F(SimplifyRun, KeepsMaterialsColoursAndNames) {
  mesh = torus(64, 48);
  const std::size_t half = mesh.triangles.size() / 2;
  MeshAttribute color{.name = "color", .components = 3, .values = {}, .rows = {}};
  for (const Vec3& p : mesh.positions)
    for (const double x : p) color.values.push_back(static_cast<float>((x + 3) / 6));
  color.rows = std::make_shared<const std::vector<Triangle>>(mesh.triangles);
  const std::vector<MeshAttribute> attributes{color};
  std::vector<Material> materials(2);
  materials[0].name = "brass";
  materials[0].base_color_texture.texture = 0;
  materials[1].name = "steel";
  materials[1].metallic = 1;
  const std::vector<TextureFile> textures{
      {"dots", encode_png({.width = 2, .height = 1, .components = 3, .bytes = {255, 0, 0, 0, 0, 255}})}};
  std::vector<std::uint32_t> face_materials(mesh.triangles.size(), 0);
  std::fill_n(face_materials.begin(), half, 1u);
  std::vector<FaceNames> names{{"object", {"wheel"}, std::vector<std::uint32_t>(mesh.triangles.size(), 0)}};
  input = folder / "wheel.glb";
  write_mesh(input, mesh,
             {.attributes = attributes,
              .materials = materials,
              .textures = textures,
              .face_materials = face_materials,
              .names = names});
  for (const std::string extension : {"glb", "obj"})
    for (const std::vector<std::string>& target :
         {std::vector<std::string>{"--triangles", "20%"}, {"--max-deviation", "0.05"}}) {
      out = folder / ("low." + extension);
      std::vector<std::string> arguments = target;
      arguments.insert(arguments.end(), {"--lods", "1", "--json"});
      const Outcome done = run(arguments);
      ASSERT_EQ(done.code, 0) << done.err;
      EXPECT_EQ(Json::parse(done.out)["notes"], Json::array());
      for (const char* name : {"low.", "low_lod1."}) {
        const MeshFile low = read_mesh_file(folder / (name + extension), {.attributes = true});
        SCOPED_TRACE(name + extension);
        EXPECT_THAT(low.notes, ::testing::IsEmpty());
        ASSERT_EQ(low.materials.size(), 2u);
        EXPECT_EQ(low.materials[1].metallic, 1);
        ASSERT_EQ(low.textures.size(), 1u);
        EXPECT_EQ(low.textures[0].bytes, textures[0].bytes);
        EXPECT_EQ(low.names[0].names, std::vector<std::string>{"wheel"});
        ASSERT_EQ(low.attributes.size(), 1u);
        std::array<std::size_t, 2> counts{};
        for (std::size_t f = 0; f < low.mesh.triangles.size(); ++f) {
          ++counts[low.face_materials[f]];
          for (int k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < 3; ++i)
              EXPECT_NEAR(low.attributes[0]
                              .values[low.attributes[0].components * (*low.attributes[0].rows)[f][k] + i],
                          (low.mesh.positions[low.mesh.triangles[f][k]][i] + 3) / 6, 1e-5);
        }
        const auto more = static_cast<double>(std::max(counts[0], counts[1]));
        EXPECT_LT(more, 0.7 * static_cast<double>(low.mesh.triangles.size()));
      }
    }
  out = folder / "low.stl";
  EXPECT_THAT(run({"--triangles", "20%"}).out,
              HasSubstr("low.stl has no materials, which " + input + " has"));
}

// What simplify makes, bake takes: with the texture coordinates of the file, and without a note on them.
TEST_F(SimplifyRun, BakeUsesTheTextureCoordinatesOfTheResult) {
  const Mesh round = with_own_uvs(sphere(5), 1024);
  input = folder / "round.ply";
  write_mesh(input, round);
  for (const char* name : {"low.glb", "low.obj", "low.ply"})
    for (const char* share : {"20%", "5%"}) {
      out = folder / name;
      ASSERT_EQ(run({"--triangles", share}).code, 0);
      const Outcome baked = run_sdm({"bake", input, out, "-o", folder / "baked", "--channels", "position",
                                     "--resolution", "256", "--no-page", "--json"});
      ASSERT_EQ(baked.code, 0) << baked.err;
      const Json json = Json::parse(baked.out);
      EXPECT_EQ(json["atlas"]["kind"], "uv") << name << ' ' << share << json["notes"];
      EXPECT_EQ(json["notes"], Json::array()) << name << ' ' << share;
    }
}

TEST_F(SimplifyRun, SaysThatNothingKeepsTheLimit) {
  const Outcome done = run({"--max-deviation", "1e-9"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("is the mesh itself, with all its triangles"));
  EXPECT_EQ(read_mesh(out).triangles, read_mesh(input).triangles);
}

TEST_F(SimplifyRun, RefusesBadTargets) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{},
                                             {"--max-deviation", "0"},
                                             {"--max-deviation", "nan"},
                                             {"--max-deviation", "-1"},
                                             {"--triangles", "0"},
                                             {"--triangles", "0%"},
                                             {"--triangles", "101%"},
                                             {"--triangles", "1.5"},
                                             {"--triangles", "10", "--max-deviation", "1"},
                                             {"--triangles", "10", "--lods", "-1"},
                                             {"--triangles", "10", "--report", ""}}) {
    const Outcome done = run(options);
    EXPECT_EQ(done.code, 2) << done.out;
    EXPECT_THAT(done.err, HasSubstr("sdm: error: "));
  }
  out = folder / "low.xyz";
  const Outcome other = run({"--triangles", "10"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr(".ply, .obj, .stl or .glb"));
  EXPECT_THAT(names_in(folder.path()), ElementsAre("sphere.obj"));
}

TEST_F(SimplifyRun, LeavesNothingAfterAFailure) {
  std::ofstream(input) << "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Outcome empty = run({"--triangles", "10"});
  EXPECT_EQ(empty.code, 1);
  EXPECT_THAT(empty.err, HasSubstr("sphere.obj"));
  write_obj(input, moved(sphere(3), {1e7, 0, 0}));  // floats are 1 apart there
  out = folder / "low.glb";
  const Outcome coarse = run({"--max-deviation", "0.001"});
  EXPECT_EQ(coarse.code, 1) << coarse.out;
  EXPECT_THAT(coarse.err, HasSubstr("float"));
  EXPECT_THAT(names_in(folder.path()), ElementsAre("sphere.obj"));
}

}  // namespace
}  // namespace sdm::test
