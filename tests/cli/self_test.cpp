// `sdm self`.
#include "cli/samples.h"
#include "support/run_sdm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <nlohmann/json.hpp>

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

struct SelfCommand : ::testing::Test, TwoTori {
  [[nodiscard]] std::vector<std::string> self(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"self", o1, "-o", out, "--resolution", "128"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(SelfCommand, WritesAllResultsWithTheNumbersOfTheLibrary) {
  for (const ExclusionRule& rule :
       {ExclusionRule{}, ExclusionRule{.rings = 2}, ExclusionRule{.geodesic = 0.7}}) {
    const bool geodesic = rule.geodesic.has_value();
    const Outcome run =
        run_sdm(self({geodesic ? "--geodesic" : "--rings", geodesic ? "0.7" : std::to_string(rule.rings),
                      "--json", "--units", "mm"}));
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "") << "progress is for terminals";
    EXPECT_EQ(names_in(out), kResults);
    EXPECT_EQ(run.out, contents(out + "/report.json"));
    const Json report = Json::parse(run.out);

    const Mesh mesh = read_mesh(o1);
    const Surface surface(mesh, {.resolution = 128});
    SelfProximityQuery query(mesh, {.exclusion = rule});
    const DistanceMap map = compute_map(surface, query.sites(), SelfOptions{.exclusion = query.exclusion()});
    const DistanceStatistics expected = statistics(surface, map);
    EXPECT_EQ(report["version"], kVersion);
    EXPECT_EQ(report["mesh"]["file"], o1);
    EXPECT_EQ(report["mesh"]["triangles"], 288);
    EXPECT_EQ(report["units"], "mm");
    EXPECT_EQ(report["atlas"]["texels"], surface.owned_texels());
    EXPECT_EQ(report["exclusion"]["rings"], geodesic ? Json(nullptr) : Json(rule.rings));
    EXPECT_EQ(report["exclusion"]["geodesic"], geodesic ? Json(0.7) : Json(nullptr));
    EXPECT_TRUE(report["max_distance"].is_null());
    EXPECT_EQ(report["separation"]["value"], query.separation()->value);
    EXPECT_EQ(report["separation"]["kind"], "exact");
    EXPECT_EQ(report["separation"]["witness"][1], (*query.separation()->witness)[1]);
    EXPECT_EQ(report["distance"]["kind"], "estimate");
    EXPECT_EQ(report["distance"]["min"], expected.min);
    EXPECT_EQ(report["distance"]["p95"], expected.p95);
    EXPECT_EQ(report["texels_with_value"], expected.texels);
    EXPECT_EQ(report["texels_without_value"], 0);
    for (const char* step : {"import", "atlas", "sites", "map", "export", "total"})
      EXPECT_GT(report["time_ms"][step], 0) << step;
  }
}

TEST_F(SelfCommand, TellsInWordsWhatItFound) {
  Outcome run = run_sdm(self());
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("(exact)"));
  EXPECT_THAT(run.out, HasSubstr(out));
  EXPECT_EQ(run_sdm(self({"--quiet"})).out, "");
  run = run_sdm(self({"--transform", "fit", "--max-distance", "1e-3", "--rings", "3"}));
  EXPECT_THAT(run.out, HasSubstr("separation  none"));
  EXPECT_THAT(run.out, HasSubstr("nothing in range"));
}

TEST_F(SelfCommand, HasTheLayersAttributesAndFieldsOfAMap) {
  ASSERT_EQ(run_sdm(self({"--write", "exr", "--channels", "distance,closest", "--field", "part=4711",
                          "--transform", "fit", "--units", "mm"}))
                .code,
            0);
  const std::string exr = contents(out + "/map.exr");
  for (const char* text : {"measuredOn", "distanceTo", "measuredOnTransform", "signReason", "measured",
                           "units", "closest.face", "distance.D"})
    EXPECT_THAT(exr, HasSubstr(text));
  EXPECT_THAT(exr, Not(HasSubstr("vector.X")));
  EXPECT_THAT(exr, Not(HasSubstr("boundary.M"))) << "it is closed";
  EXPECT_EQ(Json::parse(contents(out + "/report.json"))["fields"], Json({{"part", "4711"}}));
  write_obj(o1, height_field(8));
  ASSERT_EQ(run_sdm(self({"--write", "exr"})).code, 0);
  EXPECT_THAT(contents(out + "/map.exr"), HasSubstr("boundary.M"));
  EXPECT_EQ(run_sdm(self({"--channels", "depth"})).code, 2);
}

TEST_F(SelfCommand, NothingInRangeIsReportedWithNulls) {
  const Outcome run = run_sdm(self({"--rings", "1000", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_TRUE(report["separation"].is_null());
  EXPECT_TRUE(report["distance"]["max"].is_null());
  EXPECT_EQ(report["texels_with_value"], 0);
  EXPECT_EQ(report["texels_without_value"], report["atlas"]["texels"]);
  EXPECT_EQ(names_in(out), kResults);
}

// Each of these faces excludes all others: so many numbers would fill the memory.
TEST_F(SelfCommand, ManyFacesAtOneVertexAreAnError) {
  write_obj(o1, fan(10'100));
  const Outcome run = run_sdm(self());
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("not determined: more than 100000000 pairs of faces share a vertex"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(SelfCommand, FailuresAndWrongUsageLeaveNoTrace) {
  const std::vector<std::string> before = names_in(folder.path());
  const std::vector<std::vector<std::string>> wrong_tails{{"--rings", "0"},
                                                          {"--rings", "1.5"},
                                                          {"--geodesic", "0"},
                                                          {"--geodesic", "inf"},
                                                          {"--geodesic", "1", "--rings", "2"},
                                                          {"--max-distance", "-1"},
                                                          {"--range", "2", "1"},
                                                          {"--transform", "fot"},
                                                          {"--sign", "none"}};
  for (const auto& tail : wrong_tails) {
    const Outcome run = run_sdm(self(tail));
    EXPECT_EQ(run.code, 2) << tail[0];
    EXPECT_THAT(run.err, HasSubstr(tail[0]));
  }
  EXPECT_EQ(run_sdm({"self", o1}).code, 2);
  const Outcome missing = run_sdm({"self", folder / "missing.obj", "-o", out});
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("missing.obj"));
  const Outcome full = run_sdm(self(), {.file_size = 4000});
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, StartsWith("sdm: error: cannot write"));
  EXPECT_EQ(names_in(folder.path()), before);
}

}  // namespace
}  // namespace sdm::test
