#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "geometry/triangle.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
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
  write_mesh(scan, read_mesh(cad_part("tube.step")));
  const nlohmann::json report = cad_json({"map", scan, cad_part("tube.step"), "-o", out, "--resolution", "64",
                                          "--write", "none", "--tolerance", "0.1"});
  EXPECT_EQ(report["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(report["sign"]["method"], "exact");
  EXPECT_EQ(report["o2"]["tessellation"]["format"], "STEP");
  EXPECT_FALSE(report["o1"].contains("tessellation"));
  EXPECT_THAT(report["notes"].dump(), HasSubstr("distances are those of its triangles"));
}

// A scan in inches, of a part whose file is in inches too but read in millimetres.
TEST(CadCommand, UnitsOfAPartAreMillimetres) {
  const TemporaryFolder folder;
  const std::string scan = folder / "scan.ply", out = folder / "out";
  Mesh mesh = read_mesh(cad_part("assembly.step"));
  for (Vec3& p : mesh.positions) p = (1 / 25.4) * p;
  write_mesh(scan, mesh);
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
  write_mesh(scan, mesh);
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
  write_mesh(mesh, read_mesh(cad_part("box.step")));
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

// A ball of radius 10, whose triangles are more than 0.03 inside of it by default.
TEST(CadCommand, TolerancesHoldForTheSurface) {
  const TemporaryFolder folder;
  const std::string ball = cad_part("sphere.step");
  const auto on_ball = [](const Vec3& p, double radius) { return (radius / norm(p)) * p; };
  const Mesh coarse = read_mesh(ball);
  std::vector<Vec3> points;  // where the triangles are farthest from the ball
  for (std::uint32_t f = 0; f < coarse.triangles.size(); f += 9) {
    const auto [a, b, c] = corners_of(coarse, f);
    points.push_back(on_ball(a + b + c, 10));
  }
  const auto run = [&](const char* name, const std::vector<Vec3>& cloud, std::vector<std::string> more) {
    std::ofstream file(folder / name);
    file.precision(17);
    for (const Vec3& p : cloud) file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    file.close();
    more.insert(more.begin(),
                {"points", folder / name, ball, "-o", folder / "out", "--write", "none", "--json"});
    const Outcome outcome = run_sdm(more);
    nlohmann::json report = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(report["tolerance"]["verdict"] == "PASS", outcome.code == 0);
    return report;
  };
  const nlohmann::json perfect = run("perfect.xyz", points, {"--tolerance", "0.03"});
  EXPECT_EQ(perfect["tolerance"]["verdict"], "PASS");
  EXPECT_LE(perfect["o2"]["tessellation"]["deflection"], 0.003);
  EXPECT_EQ(perfect["evidence"]["guard"], perfect["o2"]["tessellation"]["largest_deviation"]["value"]);
  std::vector<Vec3> dented = points;
  dented[points.size() / 2] = on_ball(points[points.size() / 2], 9.91);
  const nlohmann::json dent = run("dented.xyz", dented, {"--tolerance", "0.06"});
  EXPECT_EQ(dent["tolerance"]["verdict"], "FAIL");
  EXPECT_NEAR(dent["distance"]["min"].get<double>(), -0.09, 0.015);
  // The triangles that are asked for decide nothing closer than they are.
  const nlohmann::json guarded = run("dented.xyz", dented, {"--tolerance", "0.06", "--deflection", "0.0173"});
  EXPECT_EQ(guarded["tolerance"]["verdict"], "NOT DECIDED");
  EXPECT_EQ(guarded["tolerance"]["reason"], "guard band");
  EXPECT_EQ(
      run("perfect.xyz", points, {"--tolerance", "0.1", "--deflection", "0.0173"})["tolerance"]["verdict"],
      "PASS");
  EXPECT_EQ(
      run("perfect.xyz", points, {"--tolerance", "0.03", "--deflection", "0.0173"})["tolerance"]["verdict"],
      "NOT DECIDED");
  // In other units, as the tolerance is.
  for (Vec3& p : dented) p = 0.001 * p;
  const nlohmann::json metres =
      run("metres.xyz", dented, {"--tolerance", "6e-5", "--transform-o2", "scale:0.001"});
  EXPECT_EQ(metres["tolerance"]["verdict"], "FAIL");
  EXPECT_NEAR(metres["evidence"]["guard"].get<double>(), 1e-3 * dent["evidence"]["guard"].get<double>(),
              1e-9);
}

// The same of frames: a piece of the ball, with and without a dent of 0.09.
TEST(CadCommand, FramesKeepTheirDistanceFromTheLimits) {
  const TemporaryFolder folder;
  const std::string ball = cad_part("sphere.step");
  Mesh scan = read_mesh_file(ball, {.tessellation = {.deflection = 0.006}}).mesh;
  const Mesh coarse = read_mesh(ball);
  Vec3 place{1, 0, 0};  // where triangles of the default deflection are farthest inside of the ball
  for (std::size_t f = 0; f < coarse.triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(coarse, f);
    if (const Vec3 middle = (1.0 / 3) * (a + b + c); f == 0 || norm(middle) < norm(place)) place = middle;
  }
  Vec3& dented =
      *std::ranges::max_element(scan.positions, {}, [&](const Vec3& p) { return -norm(p - place); });
  std::erase_if(scan.triangles, [&](const Triangle& t) { return norm(scan.positions[t[0]] - dented) > 1; });
  write_mesh(folder / "perfect.ply", scan);
  dented = (9.91 / norm(place)) * place;
  write_mesh(folder / "dented.ply", scan);
  const auto run = [&](const char* name, const char* tolerance, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"sequence", folder / name, ball, "-o", folder / "out", "--resolution", "64",
                               "--no-temporal", "--tolerance", tolerance});
    const Outcome outcome = run_sdm(more);
    std::ifstream lines(folder / "out/frames.jsonl");
    nlohmann::json frame = nlohmann::json::parse(lines, nullptr, false);
    EXPECT_THAT(frame["notes"].dump(), HasSubstr("verdicts keep so far from the limits"));
    return frame["distance"]["o1"];
  };
  const nlohmann::json perfect = run("perfect.ply", "0.04");
  EXPECT_EQ(perfect["verdict"], "PASS");
  EXPECT_GT(perfect["guard"], 0);
  EXPECT_LT(perfect["guard"], 0.01);
  const nlohmann::json dent = run("dented.ply", "0.07");
  EXPECT_EQ(dent["verdict"], "FAIL");
  const nlohmann::json fine = run("perfect.ply", "0.04", {"--deflection", "0.001"});
  EXPECT_EQ(fine["verdict"], "PASS");
  EXPECT_LT(fine["guard"], 0.5 * perfect["guard"].get<double>());
  const nlohmann::json metres =
      run("dented.ply", "7e-5", {"--transform-o1", "scale:0.001", "--transform-o2", "scale:0.001"});
  EXPECT_EQ(metres["verdict"], "FAIL");
  EXPECT_NEAR(metres["guard"].get<double>(), 1e-3 * dent["guard"].get<double>(), 1e-9);
}

// Options that change nothing are refused.
TEST(CadCommand, ASequenceWithoutCadHasNoDeflection) {
  const TemporaryFolder folder;
  write_mesh(folder / "cube.ply", cube());
  const std::string mesh = folder / "cube.ply";
  const auto run = [&](const char* option, const char* value) {
    return run_sdm({"sequence", mesh, mesh, "-o", folder / "out", option, value});
  };
  const Outcome cad = run("--deflection", "0.01"), welded = run("--weld", "auto");
  EXPECT_EQ(cad.code, 2) << cad.out;
  EXPECT_THAT(cad.err, HasSubstr("--deflection: applies to STEP and IGES, and no input is one of these"));
  EXPECT_EQ(welded.code, 2) << welded.out;
}

// The files of an assembly are inputs, which are not replaced.
TEST(CadCommand, PartsInFilesOfTheirOwnRemain) {
  const TemporaryFolder folder;
  std::filesystem::path part;
  for (const auto& entry : std::filesystem::directory_iterator(SDM_CAD_FILES))
    if (const std::string name = entry.path().filename(); name.starts_with("external")) {
      std::filesystem::copy_file(entry.path(), folder / name);
      if (name != "external.step") part = folder / name;
    }
  ASSERT_FALSE(part.empty());
  const auto size = std::filesystem::file_size(part);
  const Outcome run = run_sdm({"info", folder / "external.step", "--self-intersections", part});
  EXPECT_EQ(run.code, 1) << run.out;
  EXPECT_THAT(run.err, HasSubstr(part.filename().string() + ": it is the input " + part.string()));
  EXPECT_EQ(std::filesystem::file_size(part), size);
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
