// `sdm hausdorff`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/hausdorff.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

struct HausdorffCommand : ::testing::Test, TwoTori {
  static void expect_equal(const Json& json, const HausdorffDistance& expected) {
    EXPECT_EQ(json["value"], expected.distance.value);
    EXPECT_EQ(json["lower"], expected.distance.lower);
    EXPECT_EQ(json["upper"], expected.distance.upper);
    EXPECT_EQ(json["kind"], expected.distance.certainty == Certainty::exact ? "exact" : "bounded");
    EXPECT_EQ(json["witness"][0], (*expected.distance.witness)[0]);
    EXPECT_EQ(json["witness"][1], (*expected.distance.witness)[1]);
    EXPECT_EQ(json["faces"], expected.faces);
  }
};

TEST_F(HausdorffCommand, PrintsTheAnswerOfTheLibrary) {
  const Outcome run = run_sdm({"hausdorff", o1, o2, "--json", "--units", "mm", "--precision", "1e-5"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  const HausdorffDistance expected =
      one_sided_hausdorff(read_mesh(o1), Sites(read_mesh(o2)), {.precision = 1e-5});
  expect_equal(json["hausdorff"], expected);
  expect_equal(json["o1_to_o2"], expected);
  EXPECT_EQ(json["from"], "o1");
  EXPECT_EQ(json["o2_to_o1"], nullptr);
  EXPECT_FALSE(json.contains("tolerance"));
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["o1"]["vertices"], 144);
  for (const char* step : {"import", "build", "query"}) EXPECT_GT(json["time_ms"][step], 0) << step;
  EXPECT_EQ(run.err, "") << "progress is for terminals";
}

TEST_F(HausdorffCommand, MeasuresBothDirections) {
  const Outcome run = run_sdm({"hausdorff", o1, o2, "--both", "--json", "--transform-o2", "scale:2"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  Mesh second = read_mesh(o2);
  for (Vec3& p : second.positions)
    for (double& x : p) x *= 2;
  const SymmetricHausdorff expected = symmetric_hausdorff(Sites(read_mesh(o1)), Sites(second));
  expect_equal(json["hausdorff"], expected.larger);
  expect_equal(json["o1_to_o2"], expected.from[0]);
  expect_equal(json["o2_to_o1"], expected.from[1]);
  EXPECT_EQ(json["from"], "o2") << "the larger mesh";
}

TEST_F(HausdorffCommand, SaysWhatNumbersAreWorth) {
  Outcome run = run_sdm({"hausdorff", o1, o1});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("hausdorff  0 (exact)"));
  run = run_sdm({"hausdorff", o1, o2, "--both", "--units", "mm", "--precision", "0.1"});
  EXPECT_THAT(run.out, HasSubstr("(bounded)"));
  EXPECT_THAT(run.out, HasSubstr(" mm   between "));
  EXPECT_THAT(run.out, HasSubstr("O2 -> O1"));
  EXPECT_EQ(run_sdm({"hausdorff", o1, o2, "--quiet"}).out, "");
}

TEST_F(HausdorffCommand, ExitsWithThreeWhereTheToleranceIsExceeded) {
  const double distance = one_sided_hausdorff(read_mesh(o1), Sites(read_mesh(o2))).distance.lower;
  const auto run = [&](double tolerance, const std::string& more) {
    std::vector<std::string> arguments{
        "hausdorff", o1, o2, "--precision", "0.1", "--tolerance", std::to_string(tolerance)};
    if (!more.empty()) arguments.push_back(more);
    return run_sdm(arguments);
  };
  EXPECT_EQ(run(2 * distance, "").code, 0);
  EXPECT_THAT(run(2 * distance, "").out, HasSubstr("tolerance  PASS: no point is farther than "));
  EXPECT_EQ(run(0.5 * distance, "--quiet").code, 3);
  EXPECT_THAT(run(0.5 * distance, "").out, HasSubstr("tolerance  FAIL: a point is farther than "));
  // Between the bounds of that precision.
  for (const double factor : {0.9999, 1.0001}) {
    const Outcome near = run(factor * distance, "--json");
    const Json json = Json::parse(near.out);
    EXPECT_EQ(json["tolerance"]["within"], factor > 1);
    EXPECT_EQ(json["tolerance"]["certified"], true);
    EXPECT_EQ(json["tolerance"]["verdict"], factor > 1 ? "PASS" : "FAIL");
    EXPECT_EQ(near.code, factor > 1 ? 0 : 3);
  }
  EXPECT_EQ(run_sdm({"hausdorff", o1, o1, "--tolerance", "0"}).code, 0);
}

// A scan in metres lies in a corner of the part.
TEST_F(HausdorffCommand, APassInAnotherUnitIsDoubtful) {
  const std::string part = write_obj(folder / "part.obj", test::moved(cube(100), {100, 100, 100}));
  const std::string scan = write_obj(folder / "scan.obj", test::moved(cube(0.1), {0.1, 0.1, 0.1}));
  const std::vector<std::string> arguments{"hausdorff", scan, part, "--tolerance", "0.5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return run_sdm(more);
  };
  const Outcome run = with({});
  EXPECT_EQ(run.code, 5) << run.out;
  EXPECT_THAT(run.out, HasSubstr("tolerance  DOUBTFUL: no point is farther than 0.5\n  doubt      O1 "));
  EXPECT_THAT(run.out, HasSubstr("--transform-o1 scale:1000"));
  const Json json = Json::parse(with({"--json"}).out);
  EXPECT_EQ(json["tolerance"]["verdict"], "DOUBTFUL");
  EXPECT_EQ(json["tolerance"]["within"], true);
  EXPECT_EQ(json["doubts"][0]["reason"], "other unit");
  EXPECT_EQ(with({"--accept-doubts"}).code, 0);
  EXPECT_EQ(with({"--transform-o1", "scale:1000"}).code, 0);
}

// Beyond half a wall, the closest point is on the other skin.
TEST_F(HausdorffCommand, ThinWallsAreNoted) {
  const std::string box = write_obj(folder / "box.obj", cube(1));
  const std::string note = "of O2's walls are thinner than twice the tolerance";
  const auto printed = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"hausdorff", box, box});
    return run_sdm(more).out;
  };
  EXPECT_THAT(printed({"--tolerance", "2"}), HasSubstr(note));
  EXPECT_THAT(printed({"--tolerance", "0.1"}), ::testing::Not(HasSubstr(note)));
  EXPECT_THAT(printed({"--tolerance", "2", "--facing"}), ::testing::Not(HasSubstr(note)));
  EXPECT_THAT(printed({}), ::testing::Not(HasSubstr(note)));
}

TEST_F(HausdorffCommand, NamesFaults) {
  Outcome run = run_sdm({"hausdorff", o1, folder / "none.obj"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.obj"));
  EXPECT_EQ(run.out, "");
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{o1},
                                                {o1, o2, "--precision", "0"},
                                                {o1, o2, "--precision", "nan"},
                                                {o1, o2, "--tolerance", "-1"},
                                                {o1, o2, "--transform-o1", "turn:1"}}) {
    std::vector<std::string> arguments{"hausdorff"};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2) << wrong.back();
    EXPECT_EQ(run.out, "");
  }
}

}  // namespace
}  // namespace sdm::test
