// Answers of different commands to the same question.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/meshes.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

// Two closed cubes that overlap, and a box inside of the first one, near a wall of the second.
struct Consistency : ::testing::Test {
  TemporaryFolder folder;
  std::string small = folder / "small.ply", two = folder / "two.ply", out = folder / "out";

  Consistency() {
    write_mesh(small, box({0.4, 0.45, 0.45}, {0.45, 0.5, 0.5}));
    write_mesh(two, joined(box({0, 0, 0}, {1, 1, 1}), box({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75})));
  }
  [[nodiscard]] Json json(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const Outcome run = run_sdm(arguments);
    EXPECT_TRUE(run.code == 0 || run.code == 3) << run.err;
    return Json::parse(run.out);
  }
};

TEST_F(Consistency, OverlappingCubesAreOneSolidForAllCommands) {
  for (const char* sign : {"auto", "exact", "winding"}) {
    const Json map = json({"map", small, two, "-o", out, "--resolution", "64", "--sign", sign});
    EXPECT_EQ(map["negative_texels"], map["texels_with_value"]);
    EXPECT_EQ(map["sign"]["method"], "exact");
    EXPECT_EQ(map["o2"]["embedded"], false);
  }
  const auto check = [](const Json& pair) {
    EXPECT_EQ(pair["colliding"]["value"], true);
    EXPECT_EQ(pair["colliding"]["kind"], "exact");
    EXPECT_LE(pair["penetration_depth"]["lower"], 0.45);
    EXPECT_GE(pair["penetration_depth"]["upper"], 0.45);
    EXPECT_NEAR(pair["penetration_depth"]["value"], 0.45, 0.01);
  };
  check(json({"proximity", small, two}));
  check(json({"bodies", small, two})["pairs"][0]);
  const Json info = json({"info", two});
  EXPECT_GT(info["self_intersections"], 0);
  EXPECT_NEAR(info["volume"]["lower"], 1.125, 1e-12);
  EXPECT_NEAR(info["volume"]["upper"], 1.125, 1e-12);
}

TEST_F(Consistency, InfoWritesTheIntersectingFaces) {
  const std::string csv = folder / "pairs.csv";
  const Json info = json({"info", two, "--self-intersections", csv});
  const std::string text = contents(csv);
  EXPECT_THAT(text, StartsWith("face1,face2\n"));
  EXPECT_EQ(std::ranges::count(text, '\n') - 1, info["self_intersections"]);
  EXPECT_EQ(json({"info", small})["self_intersections"], 0);
  EXPECT_EQ(json({"info", small})["volume"]["lower"], json({"info", small})["volume"]["upper"]);
}

// Half of these needles cross the other half: more pairs than are tested, the same ones each time.
TEST_F(Consistency, InfoCountsIntersectionsWithinABudget) {
  Mesh needles;
  constexpr int kNeedles = 3000;
  for (int i = 0; i < kNeedles; ++i) {
    const double at = static_cast<double>(i / 2) / kNeedles, width = 0.3 / kNeedles;
    const auto first = static_cast<std::uint32_t>(needles.positions.size());
    for (const Vec3& p : {Vec3{-1, at, -0.1}, Vec3{2, at, 0.1}, Vec3{2, at + width, 0.2}})
      needles.positions.push_back(i % 2 == 0 ? p : Vec3{p[1], p[0], -p[2]});
    needles.triangles.push_back({first, first + 1, first + 2});
  }
  const std::string file = write_obj(folder / "needles.obj", needles), csv = folder / "pairs.csv";
  const Json info = json({"info", file});
  EXPECT_EQ(info["self_intersections"], nullptr);
  EXPECT_EQ(info["not_determined"], "not determined: more than 2000000 pairs of faces are near each other");
  EXPECT_GT(info["least_self_intersections"], 100'000);
  EXPECT_LT(info["least_self_intersections"], kNeedles * kNeedles / 4);
  EXPECT_THAT(run_sdm({"info", file}).out,
              HasSubstr("at least " + info["least_self_intersections"].dump() + " pairs of faces: "));
  EXPECT_EQ(run_sdm({"info", file, "--self-intersections", csv}).code, 1);
  EXPECT_FALSE(std::filesystem::exists(csv));
}

// Regression: a file name without a folder was refused.
TEST_F(Consistency, InfoWritesIntoTheCurrentFolder) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const Outcome run = run_sdm({"info", two, "--self-intersections", "here.csv"});
  std::filesystem::current_path(before);
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(contents(folder / "here.csv"), StartsWith("face1,face2\n"));
}

// Regression: a vertex that no number showed decided the verdict.
TEST_F(Consistency, TheVerdictIsThatOfTheExtremesShown) {
  const std::string o1 = folder / "o1.ply";
  write_mesh(o1, moved(sphere(2), {4, 0, 0}));
  const std::vector<std::string> map{"map", o1, small, "-o", out, "--resolution", "32"};
  const Json report = json(map);
  EXPECT_EQ(report["extremes"]["max"]["at"], "vertex");
  const double texels = report["distance"]["max"], all = report["extremes"]["max"]["distance"];
  ASSERT_GT(all, texels);
  std::vector<std::string> between = map;
  between.insert(between.end(), {"--tolerance", std::to_string(0.5 * (texels + all))});
  const Outcome run = run_sdm(between);
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.out, HasSubstr("at vertex ("));
}

// Regression: clouds were judged by a rule of their own. Of maps, python/tests/test_house.py compares all
// outputs.
TEST_F(Consistency, CloudsAreJudgedByTheRuleOfTheLibrary) {
  const std::string points = folder / "points.xyz";
  std::string text;
  for (const Vec3& p : moved(sphere(2), {4, 0, 0}).positions)
    text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
  std::ofstream(points) << text;
  for (const Tolerance tolerance : {Tolerance(10), Tolerance(4), Tolerance(4.55), Tolerance(1, 5)}) {
    const Outcome run = run_sdm({"points", points, small, "-o", out, "--units", "mm", "--accept-doubts",
                                 fmt::format("--tolerance={}:{}", tolerance.lower, tolerance.upper)});
    const Json cloud = Json::parse(contents(out + "/report.json"));
    const Json& found = cloud["evidence"];
    const Judgement judgement = judge({.lowest = found["lowest"].get<double>(),
                                       .highest = found["highest"].get<double>(),
                                       .complete = found["complete"],
                                       .estimated_signs = found["estimated_signs"],
                                       .accuracy = found["accuracy"],
                                       .error_bound = found["error_bound"],
                                       .is_signed = found["signed"]},
                                      tolerance);
    EXPECT_EQ(found["error_bound"], 0);
    EXPECT_EQ(cloud["tolerance"]["verdict"], name_of(judgement.verdict));
    EXPECT_EQ(cloud["tolerance"]["reason"], name_of(judgement.reason));
    EXPECT_EQ(cloud["tolerance"]["margin"], judgement.margin.value());
    EXPECT_THAT(run.out, HasSubstr(fmt::format("tolerance {}: ", name_of(judgement.verdict))));
  }
}

// Regression: rounding errors exceeded a tolerance of 0.
TEST_F(Consistency, AMeshIsWithinAnyToleranceOfItself) {
  const std::string ball = folder / "ball.ply";
  write_mesh(ball, placed(sphere(4), "rotate:10:20:30"));
  for (const std::string& mesh : {two, ball}) {
    const Json report = json({"map", mesh, mesh, "-o", out, "--tolerance", "0"});
    EXPECT_EQ(report["tolerance"]["within"], true);
    EXPECT_EQ(report["tolerance"]["exceeded_area_fraction"], 0);
  }
}

// Regression: the files of both kinds of run were left beside each other.
TEST_F(Consistency, ResultsOfEarlierRunsDoNotMix) {
  const std::vector<std::string> one{"map", small, two, "-o", out, "--resolution", "64"};
  std::vector<std::string> both = one;
  both.emplace_back("--both");
  ASSERT_EQ(run_sdm(both).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"o1", "o2"}));
  ASSERT_EQ(run_sdm(one).code, 0);
  EXPECT_EQ(names_in(out), kResults);
  ASSERT_EQ(run_sdm(both).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"o1", "o2"}));
}

TEST_F(Consistency, NotesSuggestWrongUnits) {
  const auto notes = [&](std::vector<std::string> more) {
    std::vector<std::string> map{"map", small, two, "-o", out, "--resolution", "64"};
    map.insert(map.end(), more.begin(), more.end());
    const Json report = json(map);
    return report["notes"].dump();
  };
  EXPECT_EQ(notes({}), "[]");
  EXPECT_THAT(notes({"--transform-o2", "scale:1000"}), HasSubstr("times the other"));
  EXPECT_THAT(notes({"--transform-o2", "translate:1000:0:0"}), HasSubstr("same place"));
  EXPECT_THAT(notes({"--max-distance", "1e-5"}), HasSubstr("no texel is within the maximum distance"));
}

TEST(Usage, UnknownNamesAreAnsweredWithTheNearest) {
  const auto error = [](const std::vector<std::string>& arguments) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, StartsWith("sdm: error: "));
    return run.err;
  };
  EXPECT_THAT(error({"mpa", "a", "b"}), HasSubstr("unknown command mpa; did you mean map?"));
  EXPECT_THAT(error({"nothing-like-it"}), HasSubstr("unknown command nothing-like-it\n"));
  EXPECT_THAT(error({"map", "a", "b", "--tolerence", "3"}), HasSubstr("did you mean --tolerance?"));
  EXPECT_THAT(error({"map"}), HasSubstr("O1 is required"));
  EXPECT_THAT(error({"map", "a", "b", "c"}), HasSubstr("unexpected argument c"));
}

TEST(Usage, HelpOfACommand) {
  EXPECT_EQ(run_sdm({"help", "map"}).out, run_sdm({"map", "--help"}).out);
  EXPECT_EQ(run_sdm({"help"}).out, run_sdm({"--help"}).out);
}

// Regression: it became the name of a folder.
TEST_F(Consistency, ResultsDoNotGoToStandardOutput) {
  const Outcome run = run_sdm({"map", small, two, "-o", "-"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("give a folder with -o"));
}

}  // namespace
}  // namespace sdm::test
