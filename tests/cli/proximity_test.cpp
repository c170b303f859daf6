// `sdm proximity` and `sdm sequence`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/proximity_query.h>
#include <sdm/sampling_bound.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/samples.h"
#include "scenes/placement.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

struct ProximityCommand : ::testing::Test, TwoTori {};

TEST_F(ProximityCommand, PrintsTheAnswersOfTheLibrary) {
  const Outcome run = run_sdm({"proximity", o1, o2, "--json", "--resolution", "128", "--units", "mm"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  ProximityQuery query(read_mesh(o1), read_mesh(o2), {.atlas = {.resolution = 128}});
  EXPECT_EQ(json["separation"]["value"], query.separation().value);
  EXPECT_EQ(json["separation"]["lower"], query.separation().lower);
  EXPECT_EQ(json["separation"]["upper"], query.separation().upper);
  EXPECT_EQ(json["separation"]["kind"], "exact") << "they intersect";
  EXPECT_EQ(json["colliding"]["value"], true);
  EXPECT_EQ(json["colliding"]["kind"], "exact");
  ASSERT_TRUE(query.penetration_depth());
  EXPECT_EQ(json["penetration_depth"]["value"], query.penetration_depth()->value);
  EXPECT_EQ(json["penetration_depth"]["witness"][0], (*query.penetration_depth()->witness)[0]);
  ASSERT_EQ(json["contacts"].size(), query.contacts().size());
  EXPECT_GT(json["contacts"].size(), 0u);
  for (std::size_t i = 0; i < query.contacts().size(); ++i) {
    EXPECT_EQ(json["contacts"][i]["depth"], query.contacts()[i].depth);
    EXPECT_EQ(json["contacts"][i]["normal"], query.contacts()[i].normal);
    EXPECT_EQ(json["contacts"][i]["point1"], query.contacts()[i].point1);
  }
  EXPECT_EQ(json["patches"], query.contacts().back().patch + 1);
  EXPECT_EQ(json["units"], "mm");
  for (const char* step : {"import", "build", "query"}) EXPECT_GT(json["time_ms"][step], 0) << step;
  EXPECT_EQ(run.err, "") << "progress is for terminals";
}

TEST_F(ProximityCommand, SaysWhatNumbersAreWorth) {
  Outcome run = run_sdm({"proximity", o1, o2, "--resolution", "128"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("colliding  yes (exact)"));
  EXPECT_THAT(run.out, HasSubstr("(bounded)"));
  EXPECT_THAT(run.out, HasSubstr("contacts"));
  run = run_sdm({"proximity", o1, o2, "--resolution", "128", "--transform-o2", "translate:9:0:0"});
  EXPECT_THAT(run.out, HasSubstr("colliding  no (exact)"));
  EXPECT_THAT(run.out, HasSubstr("contacts   0"));
}

TEST_F(ProximityCommand, AsksTheTrianglesThemselves) {
  for (const char* placement : {"translate:0:0:0", "translate:7.3:0.2:0.1"}) {
    const Outcome run = run_sdm(
        {"proximity", o1, o2, "--exact", "--json", "--resolution", "64", "--transform-o2", placement});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json json = Json::parse(run.out);
    Mesh second = read_mesh(o2);
    scenes::place(second, scenes::parse_placement(placement));
    ProximityQuery query(read_mesh(o1), second, {.atlas = {.resolution = 64}, .exact = true});
    EXPECT_EQ(json["separation"]["kind"], "exact");
    EXPECT_EQ(json["separation"]["value"], query.separation().value);
    EXPECT_EQ(json["separation"]["lower"], json["separation"]["upper"]);
    EXPECT_EQ(json["colliding"]["value"], query.colliding().value);
    EXPECT_EQ(json["colliding"]["kind"], "exact");
  }
}

TEST_F(ProximityCommand, TellsWhyThereIsNoDepth) {
  const std::string open =
      write_obj(folder / "open.obj", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}});
  const Outcome text = run_sdm({"proximity", open, open, "--resolution", "32"});
  EXPECT_THAT(text.out, HasSubstr("O1 is open (3 boundary edges); O2 is open (3 boundary edges)"));
  const Outcome run = run_sdm({"proximity", open, open, "--resolution", "32", "--json"});
  const Json json = Json::parse(run.out);
  EXPECT_TRUE(json["penetration_depth"].is_null());
  EXPECT_THAT(json["no_penetration_depth"].get<std::string>(), HasSubstr("O1 is open"));
}

TEST_F(ProximityCommand, RefusesWhatItCannotUse) {
  EXPECT_EQ(run_sdm({"proximity", o1}).code, 2);
  EXPECT_EQ(run_sdm({"proximity", o1, o2, "--margin", "-1"}).code, 2);
  EXPECT_EQ(run_sdm({"proximity", o1, o2, "--margin", "nan"}).code, 2);
  const Outcome run = run_sdm({"proximity", o1, folder / "none.obj"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.obj"));
  EXPECT_EQ(run.out, "");
}

/// The first torus passes the second one in twelve frames.
struct SequenceCommand : ProximityCommand {
  std::string moving = folder / "moving";

  SequenceCommand() {
    std::filesystem::create_directory(moving);
    for (int i = 0; i < 12; ++i) write_frame(i, ring(12, 1, {0.5 * i - 3.2, 0, 0}));
  }
  void write_frame(int i, const Mesh& mesh) const {
    write_obj(std::filesystem::path(moving) / (std::to_string(i) + ".obj"), mesh);
  }
  [[nodiscard]] std::vector<std::string> sequence(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"sequence", moving, o2, "-o", out, "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] std::vector<Json> lines() const {
    std::istringstream text(contents(out + "/frames.jsonl"));
    std::vector<Json> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
    return lines;
  }
  [[nodiscard]] std::size_t csv_rows() const {
    const std::string text = contents(out + "/frames.csv");
    return static_cast<std::size_t>(std::ranges::count(text, '\n')) - 1;
  }
};

TEST_F(SequenceCommand, FollowsTheBodies) {
  const Outcome run = run_sdm(sequence({"--maps", "5"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"frames.csv", "frames.jsonl", "maps", "max.png",
                                                     "mean.png", "min.png", "plot.png", "temporal.exr"}));
  EXPECT_EQ(names_in(out + "/maps"), (std::vector<std::string>{"0000.exr", "0000.png", "0005.exr", "0005.png",
                                                               "0010.exr", "0010.png"}));
  const std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), 12u);
  EXPECT_EQ(csv_rows(), 12u);
  ProximityQuery query(ring(12, 1, {-3.2, 0, 0}), read_mesh(o2), {.atlas = {.resolution = 64}});
  SamplingBound bound(query.surface(0));
  const RelativeError error(query.surface(0), bound);
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(all[i]["frame"], i);
    query.refit(read_mesh(std::filesystem::path(moving) / (std::to_string(i) + ".obj")).positions, {});
    EXPECT_EQ(all[i]["separation"]["value"], query.separation().value);
    EXPECT_EQ(all[i]["colliding"]["value"], query.colliding().value);
    EXPECT_EQ(all[i]["penetration_depth"]["value"], query.penetration_depth()->value);
    EXPECT_EQ(all[i]["contacts"], query.contacts().size());
    bound.refit(query.surface(0));
    EXPECT_EQ(all[i]["error_bound"]["o1"], bound.value());
    EXPECT_EQ(all[i]["relative_error"]["o1"], error.of(bound));
    EXPECT_GT(all[i]["time_ms"]["total"], 0);
  }
  EXPECT_GT(all[6]["penetration_depth"]["value"], 0.1);
  EXPECT_THAT(run.out, HasSubstr("frames     12"));
}

TEST_F(SequenceCommand, PrintsLinesAsJson) {
  const Outcome run = run_sdm(sequence({"--json", "--no-temporal"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, contents(out + "/frames.jsonl"));
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"frames.csv", "frames.jsonl", "plot.png"}));
}

// Completed frames are kept, and the message mentions them.
TEST_F(SequenceCommand, StopsAtABadFrame) {
  std::filesystem::remove(moving + "/4.obj");
  Outcome run = run_sdm(sequence());
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("frame 4"));
  EXPECT_THAT(run.err, HasSubstr("4 earlier frames are in " + out));
  std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), 5u);
  EXPECT_THAT(all[4]["error"].get<std::string>(), HasSubstr("frame 4"));
  EXPECT_EQ(csv_rows(), 4u);

  write_frame(4, ring(10));  // another mesh
  write_obj(std::filesystem::path(moving) / "7.obj", ring(12, 1, {std::nan(""), 0, 0}));
  run = run_sdm(sequence({"--keep-going"}));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("frames     10, and 2 that could not be used"));
  all = lines();
  ASSERT_EQ(all.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(all[i].contains("error"), i == 4 || i == 7) << i;
  EXPECT_EQ(csv_rows(), 10u);
}

TEST_F(SequenceCommand, PlacesAllFramesAsTheFirst) {
  const Outcome run =
      run_sdm(sequence({"--json", "--no-temporal", "--transform-o1", "scale:2,fit,translate:5:0:0"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const std::vector<Json> all = lines();
  // The torus moves by 0.5 a frame; fitted, its width is 1.
  const Box box = inspect(ring(12)).bounds;
  const double first = all[0]["separation"]["value"], last = all[11]["separation"]["value"];
  EXPECT_NEAR(last - first, 11 * 0.5 / (box.hi[0] - box.lo[0]), 0.1);
}

TEST_F(SequenceCommand, RefusesSequencesThatDoNotFit) {
  const std::string other = folder / "other";
  std::filesystem::create_directory(other);
  for (int i = 0; i < 3; ++i)
    write_obj(std::filesystem::path(other) / (std::to_string(i) + ".obj"), ring(12));
  const Outcome run = run_sdm({"sequence", moving, other, "-o", out});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("12 frames and"));
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(run_sdm({"sequence", moving, o2}).code, 2);
  EXPECT_THAT(run_sdm({"sequence", moving, o2, "-o", ""}).err, HasSubstr("the name of the folder is empty"));
  EXPECT_EQ(run_sdm(sequence({"--maps", "0"})).code, 2);
}

}  // namespace
}  // namespace sdm::test
