#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using test::run_sdm;

// A cube that is closed but for rounding, and one that is a little smaller, inside it.
class WeldOption : public testing::Test {
 protected:
  WeldOption() {
    write_mesh(open, test::taken_apart(test::cube(), 1e-6));
    write_mesh(part, test::cube(0.99));
  }

  static nlohmann::json run(std::vector<std::string> arguments, int code) {
    arguments.emplace_back("--json");
    const test::Outcome outcome = run_sdm(arguments);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }
  std::vector<std::string> map(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"map", part, open, "-o", out, "--resolution", "64", "--write", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  const test::TemporaryFolder folder;
  const std::string open = folder / "open.ply", part = folder / "part.ply", out = folder / "out";
};

TEST_F(WeldOption, GivesDistancesASign) {
  EXPECT_EQ(run(map(), 0)["sign"]["method"], "none");
  const nlohmann::json report = run(map({"--weld", "auto"}), 0);
  EXPECT_EQ(report["sign"]["method"], "exact");
  EXPECT_LT(report["extremes"]["max"]["distance"], 0);
  const nlohmann::json& weld = report["o2"]["weld"];
  EXPECT_EQ(report["o2"]["closed"], true);
  EXPECT_EQ(weld["boundary_edges"], 0);
  EXPECT_EQ(weld["t_junctions"], 0);
  EXPECT_EQ(weld["joined_vertices"], 36 - 8);
  EXPECT_GT(weld["largest_move"], 0);
  EXPECT_LE(weld["largest_move"], 4e-6);
  EXPECT_EQ(report["o1"]["weld"]["joined_vertices"], 0);
  EXPECT_EQ(report["notes"].dump().find(": 0 vertices"), std::string::npos) << "a note on nothing";
}

TEST_F(WeldOption, IsAdvisedWhereItHelps) {
  const test::Outcome unsigned_map = run_sdm(map());
  EXPECT_NE(unsigned_map.out.find("--weld auto"), std::string::npos) << unsigned_map.out;

  const test::Outcome refused = run_sdm(map({"--tolerance", "-0.02:0.001"}));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("open.ply"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("it closes with --weld auto"), std::string::npos) << refused.err;
  const nlohmann::json welded = run(map({"--tolerance", "-0.02:0.001", "--weld", "auto"}), 0);
  EXPECT_EQ(welded["tolerance"]["verdict"], "PASS");

  // A mesh that is open by more than rounding.
  const std::string sheet = folder / "sheet.ply";
  write_mesh(sheet, test::height_field(8));
  const test::Outcome of_sheet =
      run_sdm({"map", part, sheet, "-o", out, "--resolution", "64", "--write", "none"});
  EXPECT_EQ(of_sheet.code, 0) << of_sheet.err;
  EXPECT_EQ(of_sheet.out.find("--weld"), std::string::npos) << of_sheet.out;
  const test::Outcome left =
      run_sdm({"map", part, sheet, "-o", out, "--resolution", "64", "--write", "none", "--weld", "auto"});
  EXPECT_NE(left.out.find("sheet.ply: --weld joined nothing: 32 boundary edges are left"), std::string::npos)
      << left.out;
}

TEST_F(WeldOption, ValuesAtVerticesOfTheFileFollow) {
  const test::Outcome outcome =
      run_sdm({"map", open, part, "-o", out, "--resolution", "64", "--write", "csv", "--weld", "0.001"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::ifstream csv(out + "/vertices.csv");
  std::string line;
  std::getline(csv, line);
  int rows = 0;
  for (; std::getline(csv, line); ++rows) EXPECT_NE(line.back(), ',') << line;  // each has a distance
  EXPECT_EQ(rows, 36);
}

TEST_F(WeldOption, AppliesToCloudsAndPairs) {
  const std::string cloud = folder / "cloud.xyz";
  std::ofstream(cloud) << "0 0 0\n0.5 0.5 0.5\n2 0 0\n";
  const test::Outcome refused = run_sdm({"points", cloud, open, "-o", out, "--tolerance", "-1.1:1.2"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("it closes with --weld auto"), std::string::npos) << refused.err;
  const nlohmann::json points = run(
      {"points", cloud, open, "-o", out, "--tolerance", "-1.1:1.2", "--weld", "auto", "--accept-doubts"}, 0);
  EXPECT_EQ(points["negative_points"], 2);
  const nlohmann::json pair = run({"proximity", part, open, "--weld", "auto"}, 0);
  EXPECT_EQ(pair["colliding"]["value"], true);  // one is inside the other
}

TEST_F(WeldOption, RefusesWhatIsNoLength) {
  for (const char* text : {"0", "-1", "automatic", "1e", "nan"}) {
    const test::Outcome outcome = run_sdm(map({"--weld", text}));
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_NE(outcome.err.find("--weld"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace sdm
