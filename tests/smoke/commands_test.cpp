// Every subcommand of `sdm` on small files: its exit code, its files, and a number of its output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "smoke/small_meshes.h"
#include "support/error_of.h"
#include "support/oracle.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

/// Cubes of half sides 1 and 1.1, in files.
struct SmokeCommands : ::testing::Test {
  TemporaryFolder folder;
  std::string small = file_of("small.ply", cube(1)), large = file_of("large.obj", cube(1.1)),
              out = folder / "out";

  [[nodiscard]] std::string file_of(const std::string& name, const Mesh& mesh) const {
    write_mesh(folder / name, mesh);
    return folder / name;
  }
  /// What a command that exits with `code` prints with --json.
  [[nodiscard]] static nlohmann::json json_of(std::vector<std::string> arguments, int code = 0) {
    arguments.emplace_back("--json");
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
  static constexpr double kCorner =
      0.17320508075688773;  ///< from a corner of the large cube to the small one
};

TEST_F(SmokeCommands, MapWritesEveryFile) {
  const auto report =
      json_of({"map", large, small, "-o", out, "--resolution", "45", "--units", "mm", "--tolerance", "0.15",
               "--min-coverage", "0.3", "--write", "exr,views,png,glb,html,texture,ply,csv,npy,vtp"},
              3);
  EXPECT_NEAR(report["extremes"]["max"]["distance"], kCorner, 1e-5);
  EXPECT_EQ(report["tolerance"]["verdict"], "FAIL");
  EXPECT_EQ(report["sign"]["method"], "exact");
  EXPECT_GE(names_in(out).size(), 12u);
  EXPECT_THAT(names_in(out), ::testing::IsSupersetOf({"map.exr", "model.glb", "views.png", "report.json"}));
}

TEST_F(SmokeCommands, MapMeasuresByOtherRules) {
  const std::vector<std::string> first{"map",          large, small,     "-o",  out,
                                       "--resolution", "32",  "--write", "none"};
  const auto map = [&](std::vector<std::string> more, int code = 0) {
    more.insert(more.begin(), first.begin(), first.end());
    return json_of(more, code);
  };
  EXPECT_LE(map({"--facing", "60", "--atlas", "triangles"})["distance"]["max"].get<double>(), kCorner + 1e-5);
  EXPECT_GE(map({"--facing", "60"})["distance"]["min"].get<double>(), 0.1 - 1e-5);
  EXPECT_NEAR(map({"--along", "normal"})["distance"]["max"], 0.1, 1e-5);
}

TEST_F(SmokeCommands, MapAlignsAndWelds) {
  const auto map = [&](std::vector<std::string> more, int code = 0) {
    const std::vector<std::string> first{"map",          large, small,     "-o",  out,
                                         "--resolution", "32",  "--write", "none"};
    more.insert(more.begin(), first.begin(), first.end());
    return json_of(more, code);
  };
  EXPECT_EQ(map({"--engine", "reference", "--align", "--tolerance", "0.2"}, 0)["engine"], "reference");
  const std::string apart = file_of("apart.ply", taken_apart(cube(1), 1e-6));
  EXPECT_EQ(json_of({"map", large, apart, "-o", out, "--resolution", "32", "--write", "none", "--weld",
                     "auto", "--ignore-islands", "2", "--both"})["o2_to_o1"]
                .is_null(),
            true);
}

TEST_F(SmokeCommands, MapJudgesGroupsByTheirTolerances) {
  const std::string named = folder / "named.obj", table = folder / "table.csv";
  std::ofstream(named) << "v 0 0 0.05\nv 1 0 0.05\nv 1 1 0.05\nv 0 1 0.05\nv 2 0 0.05\nv 2 1 0.05\n"
                          "g left\nf 1 2 3 4\ng right\nf 2 5 6 3\n";
  std::ofstream(table) << "group,lower,upper\nleft,-0.1,0.1\nright,-0.04,0.04\n";
  const std::string sheet = file_of("sheet.ply", grid_square(8, 0, 3));
  const auto report = json_of(
      {"map", named, sheet, "-o", out, "--resolution", "32", "--write", "views", "--tolerance-table", table},
      3);
  EXPECT_EQ(report["group_tolerances"]["groups"][0]["verdict"], "PASS");
  EXPECT_EQ(report["group_tolerances"]["groups"][1]["verdict"], "FAIL");
}

TEST_F(SmokeCommands, PointsMeasuresACloud) {
  const std::string cloud = folder / "cloud.xyz";
  std::ofstream text(cloud);
  const std::vector<Vec3> points = random_points(around(cube(1)), 601, 3);
  double largest = 0;
  for (const Vec3& p : points) {
    text << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    largest = std::max(largest, oracle::brute_force(cube(1), p));
  }
  text.close();
  const auto report = json_of({"points", cloud, small, "-o", out, "--tolerance", "0.1"}, 3);
  EXPECT_EQ(report["o1"]["points"], 601);
  EXPECT_NEAR(report["extremes"]["max"]["distance"], largest, 1e-3);
  EXPECT_THAT(names_in(out), ::testing::Contains("points.ply"));
}

TEST_F(SmokeCommands, ProximityAndBodiesFindTheOverlap) {
  const auto pair =
      json_of({"proximity", small, large, "--transform-o2", "translate:1.9:0:0", "--contact-margin", "0.01"});
  EXPECT_EQ(pair["colliding"]["value"], true);
  EXPECT_NEAR(pair["separating_translation"]["value"], 0.2, 1e-4);
  const std::string poses = folder / "poses.txt";
  std::ofstream(poses) << "0 0 0  1 0 0 0\n0 0 5  1 0 0 0\n0 0 1.9  1 0 0 0\n";
  const auto bodies =
      json_of({"bodies", small, small, large, "--poses", poses, "-o", out, "--resolution", "32"});
  EXPECT_NEAR(bodies["pairs"][0]["separation"]["value"], 3, 1e-9);
  EXPECT_NEAR(bodies["pairs"][1]["penetration_depth"]["upper"], 0.2, 0.01);
  EXPECT_EQ(bodies["pairs"].size(), 3u);
}

TEST_F(SmokeCommands, HausdorffAndMetricsAgreeOnTheLargestDistance) {
  const auto found = json_of({"hausdorff", large, small, "--both"});
  EXPECT_NEAR(found["hausdorff"]["value"], kCorner, 1e-5);
  EXPECT_EQ(json_of({"hausdorff", large, small, "--tolerance", "0.1"}, 3)["tolerance"]["verdict"], "FAIL");
  const auto metrics = json_of({"metrics", large, small, "--tolerance", "0.5", "--precision", "0.02"});
  EXPECT_NEAR(metrics["metrics"]["hd"]["value"], kCorner, 0.02);
  EXPECT_EQ(metrics["metrics"]["nsd(0.5)"]["lower"], 1);
}

TEST_F(SmokeCommands, SequenceFollowsAMotion) {
  std::filesystem::create_directory(folder / "moving");
  for (int i = 0; i < 3; ++i)
    (void)file_of("moving/" + std::to_string(i) + ".ply", moved(cube(1), {2.5 + 0.25 * i, 0, 0}));
  const Outcome run = run_sdm({"sequence", folder / "moving", small, "-o", out, "--resolution", "32",
                               "--maps", "2", "--player", "--animation", "--units", "mm"});
  EXPECT_EQ(run.code, 0) << run.err;
  std::ifstream lines(out + "/frames.jsonl");
  for (int i = 0; i < 3; ++i) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_NEAR(nlohmann::json::parse(line)["separation"]["value"], 0.5 + 0.25 * i, 1e-9);
  }
  EXPECT_THAT(names_in(out), ::testing::IsSupersetOf({"frames.csv", "maps", "temporal.exr", "plot.png"}));
}

TEST_F(SmokeCommands, SelfAndThicknessFindAPlateAsThickAsItIs) {
  const std::string plate = file_of("plate.ply", box({-3, -2, 0}, {3, 2, 0.25}));
  EXPECT_NEAR(json_of({"thickness", plate, "-o", out, "--resolution", "45"})["distance"]["min"], 0.25, 1e-5);
  const std::string sheets = file_of("sheets.ply", joined(grid_square(1, 0, 3), grid_square(1, 0.3, 3)));
  const auto self = json_of({"self", sheets, "-o", out, "--resolution", "45", "--rings", "6"});
  EXPECT_NEAR(self["separation"]["value"], 0.3, 1e-9);
  EXPECT_NEAR(self["distance"]["max"], 0.3, 1e-5);
}

TEST_F(SmokeCommands, BakeMakesAModelWithTextures) {
  const std::string high = folder / "high.obj";
  std::ofstream(folder / "high.mtl") << "newmtl red\nKd 1 0 0\n";
  std::ofstream text(high);
  text << "mtllib high.mtl\nusemtl red\n";
  const Mesh mesh = grid_square(1, 0.1, 4);
  for (const Vec3& p : mesh.positions) text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    text << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  text.close();
  const std::string low = file_of("low.ply", grid_square(1, 0, 1));
  const auto report =
      json_of({"bake", high, low, "-o", out, "--resolution", "32", "--match", "ray", "--channels",
               has_tangents() ? "base_color,normal,displacement,position,face"
                              : "base_color,displacement,position,face"});
  EXPECT_FALSE(report.is_discarded());
  EXPECT_THAT(names_in(out), ::testing::Contains("baked.glb"));
}

TEST_F(SmokeCommands, VolumeAndSimplifyAndInfoStateTheirNumbers) {
  const auto volume = json_of(
      {"volume", small, "--grid", "7", "9", "5", "--max-distance", "0.3", "-o", folder / "field.vdb"});
  EXPECT_EQ(volume["grid"]["points"], (std::vector<int>{7, 9, 5}));
  const std::string fine = file_of("fine.ply", sphere(2));
  const auto simplified = json_of({"simplify", fine, "-o", folder / "coarse.glb", "--max-deviation", "0.1"});
  EXPECT_LE(simplified["levels"].empty() ? 0 : simplified["levels"][0]["deviation"]["upper"].get<double>(),
            0.1);
  EXPECT_LT(read_mesh(folder / "coarse.glb").triangles.size(), 200u);
  const auto info = json_of({"info", small});
  EXPECT_EQ(info["triangles"], 12);
  EXPECT_NEAR(info["area"], 24, 1e-9);
}

TEST_F(SmokeCommands, DevicesScenesAndCompletions) {
  const bool device = error_of(gl_devices).empty() || error_of(gpu_devices).empty();
  EXPECT_EQ(run_sdm({"devices"}).code, device ? 0 : 1);
  const Outcome scene = run_sdm({"scene", "letters", "-o", out, "--frames", "2"});
  EXPECT_EQ(scene.code, 0) << scene.err;
  EXPECT_THAT(names_in(out), ::testing::Contains("scene.json"));
  const Outcome completion = run_sdm({"completion", "bash"});
  EXPECT_EQ(completion.code, 0);
  EXPECT_THAT(completion.out, ::testing::HasSubstr("hausdorff"));
  EXPECT_EQ(run_sdm({"map", "--help"}).code, 0);
  EXPECT_EQ(run_sdm({"none"}).code, 2);
}

}  // namespace
}  // namespace sdm::test
