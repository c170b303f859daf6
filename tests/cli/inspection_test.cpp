// From a scan to a verdict: a made scan, of which the answers are known, by one command each.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/meshes.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

struct Inspection : ::testing::Test {
  TemporaryFolder folder;
  std::string made = folder / "made", out = folder / "out";
  Json truth;
  double depth = 0, noise = 0;

  void SetUp() override {
    const Outcome run =
        run_sdm({"scene", "scan", "--mesh", mesh_file("fandisk.off"), "--triangles", "8000", "-o", made});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(names_in(made), ::testing::ElementsAre("part.ply", "scan.ply", "scan.xyz", "scene.json"));
    truth = Json::parse(contents(made + "/scene.json"));
    depth = truth["dent"]["depth"];
    noise = truth["noise"];
  }

  Outcome measure(const std::string& command, const std::string& scan, double tolerance,
                  std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{command, made + "/" + scan, made + "/part.ply",        "--align", "-o",
                                       out,     "--tolerance",     std::to_string(tolerance), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }

  /// How far the alignment and the placement of the scan are from undoing each other, at a corner of the
  /// part.
  [[nodiscard]] double alignment_error(const Json& report) const {
    const auto map = [](const Json& matrix, const Vec3& p) {
      Vec3 q;
      for (int row = 0; row < 3; ++row) {
        q[row] = matrix[row][3];
        for (int k = 0; k < 3; ++k) q[row] += matrix[row][k].get<double>() * p[k];
      }
      return q;
    };
    const Box box = bounds(load("fandisk.off"));
    double error = 0;
    for (const Vec3& corner : {box.lower, box.upper, Vec3{box.lower[0], box.upper[1], box.lower[2]}})
      error =
          std::max(error, norm(map(report["alignment"]["matrix"], map(truth["matrix"], corner)) - corner));
    return error;
  }

  void check_findings(const Json& report) const {
    EXPECT_LT(alignment_error(report), 0.5 * noise);
    const Json& min = report["extremes"]["min"];
    EXPECT_NEAR(min["distance"], -depth, 4 * noise);
    const Vec3 at{min["point"].get<std::array<double, 3>>()};
    const Vec3 place{truth["dent"]["place"].get<std::array<double, 3>>()};
    EXPECT_LT(norm(at - place), 0.5 * truth["dent"]["radius"].get<double>());
    EXPECT_LT(report["extremes"]["max"]["distance"], 5 * noise);
    EXPECT_NEAR(report["distance"]["p50"], 0, 0.2 * noise);
  }
};

TEST_F(Inspection, OfAMesh) {
  const std::vector<std::string> fast{"--write", "none", "--resolution", "256"};
  const Outcome fails = measure("map", "scan.ply", 0.7 * depth, fast);
  EXPECT_EQ(fails.code, 3) << fails.err;
  const Json report = Json::parse(fails.out);
  check_findings(report);
  EXPECT_EQ(report["tolerance"]["verdict"], "FAIL");
  const double dented = M_PI * std::pow(truth["dent"]["radius"].get<double>(), 2);
  EXPECT_LT(report["tolerance"]["exceeded_area_fraction"], 0.2 * dented);

  // All points of the surface, not only all samples: the margin is above the error bound.
  const Outcome passes =
      measure("map", "scan.ply", 2 * depth, {"--write", "none", "--resolution", "512", "--json"});
  EXPECT_EQ(passes.code, 0) << passes.err;
  EXPECT_EQ(Json::parse(passes.out)["tolerance"]["verdict"], "PASS");
}

// From the scan the dent, from the part what the scan lacks.
TEST_F(Inspection, OfBothSides) {
  const Outcome run =
      measure("map", "scan.ply", 2 * depth, {"--write", "none", "--resolution", "512", "--both"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json reports = Json::parse(run.out);
  check_findings(reports["o1"]);
  EXPECT_EQ(reports["o1"]["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(reports["o2"]["tolerance"]["verdict"], "FAIL");
  EXPECT_NEAR(reports["o2"]["tolerance"]["exceeded_area_fraction"], truth["missing_area_fraction"], 0.05);
}

TEST_F(Inspection, OfACloud) {
  const Outcome fails = measure("points", "scan.xyz", 0.7 * depth);
  EXPECT_EQ(fails.code, 3) << fails.err;
  const Json report = Json::parse(fails.out);
  check_findings(report);
  EXPECT_EQ(report["tolerance"]["verdict"], "FAIL");
  const Outcome passes = measure("points", "scan.xyz", depth + 4 * noise);
  EXPECT_EQ(passes.code, 0) << passes.err;
  EXPECT_EQ(Json::parse(passes.out)["tolerance"]["verdict"], "PASS");
}

TEST_F(Inspection, MadeScansAreRefusedWithoutAPartThatFits) {
  const std::string other = folder / "other";
  EXPECT_EQ(run_sdm({"scene", "scan", "-o", other}).code, 2);
  EXPECT_EQ(run_sdm({"scene", "letters", "--triangles", "500", "-o", other}).code, 2);
  EXPECT_EQ(run_sdm({"scene", "scan", "--mesh", made + "/part.ply", "--frames", "3", "-o", other}).code, 2);
  const std::string ball = write_obj(folder / "ball.obj", sphere(5));
  const Outcome curved = run_sdm({"scene", "scan", "--mesh", ball, "-o", other});
  EXPECT_EQ(curved.code, 1);
  EXPECT_THAT(curved.err, HasSubstr("ball.obj: the part has no flat place for a dent"));
  EXPECT_FALSE(std::filesystem::exists(other));
}

}  // namespace
}  // namespace sdm::test
