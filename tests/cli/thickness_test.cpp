// `sdm thickness`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/samples.h"
#include "io_write/read_png.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"
#include "support/thickness.h"

namespace sdm::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A plate of 6 × 4 × 0.5.
class ThicknessCommandTest : public ::testing::Test {
 protected:
  ThicknessCommandTest() {
    for (Vec3& p : plate.positions) p = {3 * p[0], 2 * p[1], 0.25 * p[2]};
    write_mesh(part, plate);
    write_mesh(open, taken_apart(plate, 1e-6));
  }
  [[nodiscard]] Outcome run(const std::string& file, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"thickness", file, "-o", out, "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }

  Mesh plate = cube();
  const TemporaryFolder folder;
  const std::string part = folder / "part.ply", open = folder / "open.ply", out = folder / "out";
};

TEST_F(ThicknessCommandTest, WritesTheNumbersOfTheLibrary) {
  for (const std::string method : {"ball", "ray"}) {
    const Outcome outcome = run(part, {"--method", method, "--json", "--units", "mm"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, contents(out + "/report.json"));
    const Json report = Json::parse(outcome.out);
    const Mesh mesh = read_mesh(part);
    const Surface surface(mesh, {.resolution = 64});
    const ThicknessMaps maps = thickness_maps(surface, Sites(mesh));
    const DistanceStatistics ball = statistics(surface, maps.ball), ray = statistics(surface, maps.ray);
    const bool is_ball = method == "ball";
    EXPECT_EQ(report["distance"]["min"], (is_ball ? ball : ray).min);
    EXPECT_EQ(report["distance"]["p95"], (is_ball ? ball : ray).p95);
    EXPECT_EQ(report["thickness"]["method"], method);
    EXPECT_EQ(report["measured"]["kind"], "thickness");
    EXPECT_EQ(report["measured"]["text"], (is_ball ? maps.ball : maps.ray).measured.text);
    EXPECT_EQ(report["thickness"]["other"]["method"], is_ball ? "ray" : "ball");
    EXPECT_EQ(report["thickness"]["other"]["distance"]["mean"], (is_ball ? ray : ball).mean);
    EXPECT_EQ(report["thickness"]["thinnest"][0]["thickness"], (is_ball ? ball : ray).min);
    EXPECT_EQ(report["evidence"]["samples_only"], true);
    EXPECT_FALSE(report.contains("error_bound"));
    EXPECT_FALSE(report.contains("tolerance"));
    EXPECT_THAT(names_in(out), Contains(is_ball ? "ray.exr" : "ball.exr"));
    EXPECT_THAT(names_in(out), Contains("report.html"));
    EXPECT_THAT(contents(out + "/report.html"), HasSubstr("samples_only"));
  }
}

TEST_F(ThicknessCommandTest, HasTheLayersAndAttributesOfAMapByEitherMethod) {
  ASSERT_EQ(run(part, {"--write", "exr", "--channels", "distance,position", "--field", "part=4711"}).code, 0);
  for (const auto& [file, text] :
       {std::pair("map.exr", "largest ball"), std::pair("ray.exr", "the ray along")}) {
    const std::string exr = contents(out + "/" + file);
    for (const char* found : {"measuredOn", "signReason", text, "position.X", "distance.D"})
      EXPECT_THAT(exr, HasSubstr(found)) << file;
    EXPECT_EQ(exr.find("vector.X"), std::string::npos) << file;
  }
  EXPECT_EQ(Json::parse(contents(out + "/report.json"))["fields"]["part"], "4711");
}

TEST_F(ThicknessCommandTest, JudgesLimitsByItsTexels) {
  Outcome outcome = run(part, {"--min", "0.4", "--units", "mm"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("PASS: every measured point has at least 0.4 mm; between them, an estimate"));
  outcome = run(part, {"--min", "0.6"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("does not have at least 0.6; 0.5 at ("));
  outcome = run(part, {"--min", "0.5"});
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.out,
              HasSubstr("NOT DECIDED: a measured point is as close to the limit, at least 0.5, as"));
  EXPECT_EQ(Json::parse(run(part, {"--min", "0.4", "--json"}).out)["tolerance"]["text"],
            "every measured point has at least 0.4; between them, an estimate");
  EXPECT_EQ(run(part, {"--max", "6.1"}).code, 0);
  const Json open_above = Json::parse(run(part, {"--min", "0.4", "--json"}).out);
  EXPECT_TRUE(open_above["tolerance"]["upper"].is_null());
  EXPECT_EQ(open_above["tolerance"]["lower"], 0.4);
  EXPECT_FALSE(open_above["thickness"].contains("thickest"));
  outcome = run(part, {"--min", "0.4", "--max", "5", "--json"});
  EXPECT_EQ(outcome.code, 3);
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report["tolerance"]["verdict"], "FAIL");
  EXPECT_EQ(report["tolerance"]["nearest_limit"], "upper");
  EXPECT_EQ(report["thickness"]["max"], 5);
}

TEST_F(ThicknessCommandTest, StatesItsVerdictInViews) {
  for (const auto& [limit, color] : {std::pair("0.4", io::Rgb{0, 97, 61}), {"0.6", io::Rgb{163, 19, 14}}}) {
    (void)run(part, {"--min", limit, "--write", "views"});
    EXPECT_GT(std::ranges::count(read_png(out + "/views.png").colors, color), 1000) << limit;
  }
}

TEST_F(ThicknessCommandTest, AnUpperLimitAloneListsTheThickestPlaces) {
  const Json report = Json::parse(run(part, {"--max", "5", "--json"}).out);
  EXPECT_TRUE(report["tolerance"]["lower"].is_null());
  EXPECT_EQ(report["tolerance"]["upper"], 5);
  EXPECT_FALSE(report["thickness"].contains("thinnest"));
  EXPECT_EQ(report["thickness"]["thickest"][0]["thickness"], report["distance"]["max"]);
  EXPECT_THAT(contents(out + "/report.html"), HasSubstr("\"thickest\":["));
  const Outcome outcome = run(part, {"--max", "5"});
  EXPECT_THAT(outcome.out, HasSubstr("              most at ("));
  EXPECT_THAT(outcome.out, ::testing::Not(HasSubstr("least at")));
}

// Bands around the limit that was given, and none around one that was not.
TEST_F(ThicknessCommandTest, BandsAreThoseOfTheLimitsThatWereGiven) {
  const auto edges = [&](const std::vector<std::string>& limits) {
    std::vector<std::string> options{"--json", "--write", "none"};
    options.insert(options.end(), limits.begin(), limits.end());
    std::vector<double> result;
    const Json report = Json::parse(run(part, options).out);
    for (const Json& band : report["bands"])
      if (!band["upper"].is_null()) result.push_back(band["upper"]);
    return result;
  };
  EXPECT_EQ(edges({"--min", "0.25"}), (std::vector{0.125, 0.25, 0.5}));
  EXPECT_EQ(edges({"--max", "5"}), (std::vector{2.5, 5.0, 10.0}));
  EXPECT_EQ(edges({"--min", "0.25", "--max", "0.75"}), (std::vector{0.25, 0.5, 0.75, 1.25}));
}

TEST_F(ThicknessCommandTest, NamesWhatClosesAnOpenPart) {
  Outcome outcome = run(open);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("open.ply"));
  EXPECT_THAT(outcome.err, HasSubstr("it closes with --weld auto"));
  EXPECT_FALSE(std::filesystem::exists(out));
  outcome = run(open, {"--weld", "auto", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(Json::parse(outcome.out)["distance"]["min"], 0.5, 1e-4);
  write_mesh(open, height_field(8));
  outcome = run(open);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("close its holes"));
}

TEST_F(ThicknessCommandTest, WrongUsageLeavesNoTrace) {
  for (const std::vector<std::string>& tail :
       std::vector<std::vector<std::string>>{{"--method", "sphere"},
                                             {"--angle", "0"},
                                             {"--angle", "180"},
                                             {"--min", "0"},
                                             {"--max", "-1"},
                                             {"--min", "2", "--max", "1"}}) {
    const Outcome outcome = run(part, tail);
    EXPECT_EQ(outcome.code, 2) << tail[0];
    EXPECT_THAT(outcome.err, HasSubstr(tail[0]));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(ThicknessCommandTest, ALimitAboveTheDiagonalFails) {
  const Outcome outcome = run(part, {"--min", "200"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(run(part, {"--min", "1e300"}).code, 3);
}

TEST_F(ThicknessCommandTest, ConnectedSolidsAreNotCalledOpen) {
  Mesh two = plate;
  for (const Vec3& p : plate.positions) two.positions.push_back(p + Vec3{0, 0, 0.5});
  const auto count = static_cast<std::uint32_t>(plate.positions.size());
  for (const Triangle& t : plate.triangles)
    two.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  // The upper plate stands on vertices of the lower one.
  for (Triangle& t : two.triangles)
    for (std::uint32_t& v : t)
      for (std::uint32_t w = 0; w < count; ++w)
        if (two.positions[v] == two.positions[w]) v = w;
  const std::string file = folder / "two.ply";
  write_mesh(file, two);
  const Outcome outcome = run(file);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("4 edges of this one have more than two faces"));
}

}  // namespace
}  // namespace sdm::test
