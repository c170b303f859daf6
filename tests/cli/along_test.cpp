// `sdm map --along`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

// Terrain, and the same after it sank by 0.25.
class AlongOption : public ::testing::Test {
 protected:
  AlongOption() {
    write_mesh(before, height_field(8));
    write_mesh(after, moved(height_field(8), {0, 0, -0.25}));
  }
  [[nodiscard]] Outcome run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"map", after, before, "-o", out, "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }

  const TemporaryFolder folder;
  const std::string before = folder / "before.ply", after = folder / "after.ply", out = folder / "out";
};

TEST_F(AlongOption, StatesTheChangeOfHeightAtItsSamples) {
  const Outcome outcome = run({"--along", "0,0,1", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, contents(out + "/report.json"));
  const Json report = Json::parse(outcome.out);
  const Surface surface(read_mesh(after), {.resolution = 64});
  const DistanceMap map =
      compute_map(surface, Sites(read_mesh(before)), AlongOptions{.direction = Vec3{0, 0, 1}});
  const DistanceStatistics expected = statistics(surface, map);
  EXPECT_EQ(report["measured"]["kind"], "along");
  EXPECT_EQ(report["without_match"], map.without_match);
  EXPECT_EQ(report["distance"]["mean"], expected.mean);
  EXPECT_NEAR(report["distance"]["max"], -0.25, 1e-6);
  EXPECT_NEAR(report["distance"]["min"], -0.25, 1e-6);
  EXPECT_TRUE(report["error_bound"].is_null());
  EXPECT_TRUE(report["hausdorff"]["one_sided"]["lower"].is_null());
  EXPECT_EQ(report["evidence"]["samples_only"], true);
}

TEST_F(AlongOption, IsJudgedByItsSamplesWithSigns) {
  // Without the border, where rounding decides whether a line meets O2.
  const std::string small = folder / "small.ply";
  Mesh mesh = read_mesh(after);
  for (Vec3& p : mesh.positions) p = {0.9 * p[0], 0.9 * p[1], -3};
  write_mesh(small, mesh);
  for (Vec3& p : mesh.positions) p = {p[0] / 0.9, p[1] / 0.9, -2.75};
  write_mesh(before, mesh);
  const auto judged = [&](const std::string& tolerance) {
    return run_sdm({"map", small, before, "-o", out, "--resolution", "64", "--along", "0,0,2", "--tolerance",
                    tolerance});
  };
  const Outcome pass = judged("-0.3:0.1"), fail = judged("-0.1:0.3");
  EXPECT_EQ(pass.code, 0) << pass.out << pass.err;
  EXPECT_THAT(pass.out, HasSubstr("measured  distance along the direction (0 0 2)"));
  EXPECT_THAT(pass.out, HasSubstr("every measured point of the surface is within -0.3 to 0.1, an estimate"));
  EXPECT_THAT(pass.out, HasSubstr("unknown between the texels"));
  EXPECT_EQ(fail.code, 3) << fail.out;
}

TEST_F(AlongOption, SaysBehindAndNamesTheLine) {
  EXPECT_THAT(run({"--along", "0,0,1"}).out, HasSubstr("is behind (negative)"));
  write_mesh(after, flipped(read_mesh(after)));
  const Outcome turned = run({"--along", "0,0,1", "--tolerance", "0.1"});
  EXPECT_EQ(turned.code, 3);
  EXPECT_THAT(turned.out, HasSubstr("no texel has such a face on its line"));
  EXPECT_THAT(turned.out, HasSubstr("texels have no such face on their line"));
  EXPECT_THAT(turned.out, HasSubstr("FAIL: 100 % of the area has no value, as no face of the reference"));
}

TEST_F(AlongOption, NormalsMayBeTheLines) {
  const Outcome outcome = run({"--along", "normal", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report["measured"]["text"], "distance along the normal of the sample's face, to both sides");
  EXPECT_LT(report["distance"]["max"], 0);
}

TEST_F(AlongOption, WrongUsageLeavesNoTrace) {
  for (const char* direction : {"0,0,0", "1,2", "1,2,3,4", "up", "1,2,", "1,inf,0", ""}) {
    const Outcome outcome = run({"--along", direction});
    EXPECT_EQ(outcome.code, 2) << direction;
    EXPECT_THAT(outcome.err, HasSubstr("--along")) << direction;
  }
  for (const std::vector<std::string>& other : std::vector<std::vector<std::string>>{
           {"--sign", "none"}, {"--engine", "reference"}, {"--facing", "60"}}) {
    const Outcome outcome = run({"--along", "normal", other[0], other[1]});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--along excludes " + other[0]));
  }
  const Outcome bounded =
      run_sdm({"map", after, before, "-o", out, "--precision", "0.1", "--along", "normal"});
  EXPECT_EQ(bounded.code, 2);
  EXPECT_THAT(bounded.err,
              HasSubstr("--precision excludes --along: nothing bounds such distances between samples"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace sdm::test
