// `sdm proximity`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/proximity_query.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "io/mesh/placement.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

struct ProximityCommand : ::testing::Test, TwoTori {};

TEST_F(ProximityCommand, PrintsTheAnswersOfTheLibrary) {
  const Outcome run = run_sdm({"proximity", o1, o2, "--json", "--units", "mm"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  ProximityQuery query(read_mesh(o1), read_mesh(o2));
  EXPECT_EQ(json["separation"]["value"], query.separation().value);
  EXPECT_EQ(json["separation"]["lower"], query.separation().lower);
  EXPECT_EQ(json["separation"]["upper"], query.separation().upper);
  EXPECT_EQ(json["separation"]["kind"], "exact") << "they intersect";
  EXPECT_EQ(json["colliding"]["value"], true);
  EXPECT_EQ(json["colliding"]["kind"], "exact");
  ASSERT_TRUE(query.penetration_depth());
  EXPECT_EQ(json["penetration_depth"]["value"], query.penetration_depth()->value);
  EXPECT_EQ(json["penetration_depth"]["witness"][0], (*query.penetration_depth()->witness)[0]);
  const SeparatingTranslation& leaving = query.separating_translation();
  EXPECT_EQ(json["separating_translation"]["value"], leaving.value);
  EXPECT_EQ(json["separating_translation"]["lower"], leaving.lower);
  EXPECT_EQ(json["separating_translation"]["upper"], leaving.upper);
  EXPECT_EQ(json["separating_translation"]["kind"], "bounded");
  EXPECT_EQ(json["separating_translation"]["translation"], leaving.translation);
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
  Outcome run = run_sdm({"proximity", o1, o2});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("colliding  yes (exact)"));
  EXPECT_THAT(run.out, HasSubstr("(bounded)")) << "the depth";
  EXPECT_THAT(run.out, HasSubstr("  to leave   "));
  EXPECT_THAT(run.out, HasSubstr("            moving O1 by ("));
  EXPECT_THAT(run.out, HasSubstr("contacts"));
  run = run_sdm({"proximity", o1, o2, "--transform-o2", "translate:9:0:0"});
  EXPECT_THAT(run.out, HasSubstr("colliding  no (exact)"));
  EXPECT_THAT(run.out, HasSubstr("contacts   0"));
  EXPECT_THAT(run.out, Not(HasSubstr("to leave")));
}

TEST_F(ProximityCommand, AsksTheTrianglesThemselves) {
  for (const char* placement : {"translate:0:0:0", "translate:7.3:0.2:0.1"}) {
    const Outcome run = run_sdm({"proximity", o1, o2, "--json", "--transform-o2", placement});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json json = Json::parse(run.out);
    Mesh second = read_mesh(o2);
    io::place(second, io::parse_placement(placement));
    ProximityQuery query(read_mesh(o1), second);
    EXPECT_EQ(json["separation"]["kind"], "exact");
    EXPECT_EQ(json["separation"]["value"], query.separation().value);
    EXPECT_EQ(json["separation"]["lower"], json["separation"]["upper"]);
    EXPECT_EQ(json["colliding"]["value"], query.colliding());
    EXPECT_EQ(json["colliding"]["kind"], "exact");
  }
}

TEST_F(ProximityCommand, TellsWhyThereIsNoDepth) {
  const std::string open =
      write_obj(folder / "open.obj", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}});
  const Outcome text = run_sdm({"proximity", open, open});
  EXPECT_THAT(text.out, HasSubstr("O1 is open (3 boundary edges); O2 is open (3 boundary edges)"));
  const Outcome run = run_sdm({"proximity", open, open, "--json"});
  const Json json = Json::parse(run.out);
  EXPECT_TRUE(json["penetration_depth"].is_null());
  EXPECT_THAT(json["no_penetration_depth"].get<std::string>(), HasSubstr("O1 is open"));
}

TEST_F(ProximityCommand, RefusesWhatItCannotUse) {
  EXPECT_EQ(run_sdm({"proximity", o1}).code, 2);
  EXPECT_EQ(run_sdm({"proximity", o1, o2, "--contact-margin", "-1"}).code, 2);
  EXPECT_EQ(run_sdm({"proximity", o1, o2, "--contact-margin", "nan"}).code, 2);
  const Outcome run = run_sdm({"proximity", o1, folder / "none.obj"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.obj"));
  EXPECT_EQ(run.out, "");
}

}  // namespace
}  // namespace sdm::test
