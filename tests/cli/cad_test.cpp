#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/io.h>
#include <sdm/transform.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/run_sdm.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string cad_part(const std::string& name) {
  return std::string(SDM_CAD_FILES) + "/" + name;
}

nlohmann::json cad_json(std::vector<std::string> arguments, int code = 0) {
  arguments.emplace_back("--json");
  const Outcome outcome = run_sdm(arguments);
  EXPECT_EQ(outcome.code, code) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  return nlohmann::json::parse(outcome.out, nullptr, false);
}

TEST(CadCommand, InfoSaysWhatWasTessellated) {
  const Outcome text = run_sdm({"info", cad_part("tube.step")});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.err, IsEmpty());
  EXPECT_THAT(text.out, HasSubstr("estimate"));
  EXPECT_THAT(run_sdm({"info", cad_part("assembly.step")}).out,
              HasSubstr("INCH in the file, converted to mm"));
  const nlohmann::json info = cad_json({"info", cad_part("tube.step"), "--deflection", "0.01"});
  EXPECT_EQ(info["closed"], true);
  EXPECT_EQ(info["tessellation"]["deflection"], 0.01);
  EXPECT_EQ(info["tessellation"]["largest_deviation"]["kind"], "estimate");
  EXPECT_LE(info["tessellation"]["largest_deviation"]["value"], 0.01);
}

TEST(CadCommand, MapToAPartHasItsTessellationAndANote) {
  const TemporaryFolder folder;
  const std::string scan = folder / "scan.ply", out = folder / "out";
  write_ply(scan, read_mesh(cad_part("tube.step")));
  const nlohmann::json report = cad_json({"map", scan, cad_part("tube.step"), "-o", out, "--resolution", "64",
                                          "--write", "none", "--tolerance", "0.1"});
  EXPECT_EQ(report["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(report["sign"]["method"], "exact");
  EXPECT_EQ(report["o2"]["tessellation"]["format"], "STEP");
  EXPECT_FALSE(report["o1"].contains("tessellation"));
  EXPECT_THAT(report["notes"].dump(), HasSubstr("hold for its triangles"));
}

// A scan in inches, of a part whose file is in inches too but read in millimetres.
TEST(CadCommand, UnitsOfAPartAreMillimetres) {
  const TemporaryFolder folder;
  const std::string scan = folder / "scan.ply", out = folder / "out";
  Mesh mesh = read_mesh(cad_part("assembly.step"));
  for (Vec3& p : mesh.positions) p = (1 / 25.4) * p;
  write_ply(scan, mesh);
  const nlohmann::json report =
      cad_json({"map", scan, cad_part("assembly.step"), "-o", out, "--resolution", "64", "--write", "none",
                "--units-o1", "in", "--tolerance", "0.001"});
  EXPECT_EQ(report["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(report["units"], "mm");
}

// The part to a scan without it: a face that is off fails, the others pass.
TEST(CadCommand, FacesHaveTolerancesOfTheirOwn) {
  const TemporaryFolder folder;
  const std::string scan = folder / "scan.ply", table = folder / "table.csv";
  Mesh mesh = read_mesh(cad_part("assembly.step"));
  for (Vec3& p : mesh.positions)
    if (p[2] > 12 && p[2] < 13) p[2] += 0.3;
  write_ply(scan, mesh);
  std::ofstream(table) << "group,lower,upper\nplate (2),-0.01,0.01\ndatum A,-0.1,0.1\n";
  const nlohmann::json report =
      cad_json({"map", cad_part("assembly.step"), scan, "-o", folder / "out", "--resolution", "64", "--write",
                "none", "--tolerance-table", table},
               3);
  const nlohmann::json& groups = report["group_tolerances"]["groups"];
  EXPECT_EQ(groups[0]["kind"], "object");
  EXPECT_EQ(groups[0]["verdict"], "PASS");
  EXPECT_EQ(groups[1]["kind"], "face");
  EXPECT_EQ(groups[1]["verdict"], "FAIL");
  EXPECT_NEAR(groups[1]["lowest"].get<double>(), -0.3, 1e-3);
}

TEST(CadCommand, FaultsAreOneSentence) {
  const TemporaryFolder folder;
  const Outcome none = run_sdm({"info", cad_part("line.step")});
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.out, IsEmpty());
  EXPECT_THAT(none.err, HasSubstr("line.step: has no faces\n"));
  const std::string mesh = folder / "box.ply";
  write_ply(mesh, read_mesh(cad_part("box.step")));
  const Outcome unused = run_sdm({"info", mesh, "--deflection", "0.1"});
  EXPECT_EQ(unused.code, 2);
  EXPECT_THAT(unused.err, HasSubstr("applies to STEP and IGES"));
}

// They would be printed beside numbers in millimetres.
TEST(CadCommand, OtherUnitsAreRefusedUnlessConverted) {
  const TemporaryFolder folder;
  const std::string box = cad_part("box.step"), out = folder / "out";
  const std::vector<std::vector<std::string>> commands{{"map", box, box, "-o", out},
                                                       {"hausdorff", box, box},
                                                       {"proximity", box, box},
                                                       {"thickness", box, "-o", out},
                                                       {"self", box, "-o", out},
                                                       {"bodies", box, box},
                                                       {"volume", box, "-o", out, "--spacing", "5"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--units", "m"});
    const Outcome refused = run_sdm(command);
    EXPECT_EQ(refused.code, 2) << command[0];
    EXPECT_THAT(refused.err, HasSubstr("--units: must be mm, not m, as " + box + " is read in mm"));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
  const nlohmann::json scaled = cad_json({"hausdorff", box, box, "--units", "m", "--transform-o1",
                                          "scale:0.001", "--transform-o2", "scale:0.001"});
  EXPECT_EQ(scaled["units"], "m");
  const nlohmann::json converted = cad_json({"map", box, box, "-o", out, "--resolution", "64", "--write",
                                             "none", "--units", "m", "--units-o1", "mm"});
  EXPECT_EQ(converted["units"], "m");
}

TEST(CadCommand, ThicknessFollowsTheDeflection) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{
      "thickness", cad_part("tube.step"), "-o", folder / "out", "--resolution", "64", "--write", "none"};
  std::vector<std::string> fine = command;
  fine.insert(fine.end(), {"--deflection", "0.001"});
  const nlohmann::json by_default = cad_json(command), finer = cad_json(fine);
  EXPECT_EQ(finer["mesh"]["tessellation"]["deflection"], 0.001);
  EXPECT_GT(finer["mesh"]["triangles"], by_default["mesh"]["triangles"]);
}

TEST(CadCommand, ACrashOfOpenCascadeIsOneSentence) {
  const TemporaryFolder folder;
  const std::string file = folder / "bad.step";
  std::ifstream in(cad_part("box.step"));
  std::ofstream damaged(file);
  for (std::string line; std::getline(in, line);) {
    if (const std::size_t at = line.find("FACE_BOUND"); at != std::string::npos) line[at + 7] = 'N';
    damaged << line << "\n";
  }
  damaged.close();
  const Outcome outcome = run_sdm({"info", file});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("bad.step: OpenCASCADE cannot read it; it is damaged\n"));
}

}  // namespace
}  // namespace sdm::test
