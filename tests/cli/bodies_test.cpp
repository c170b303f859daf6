// `sdm bodies`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/same_contents.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// Two tori that cross, and one 10 away.
struct BodiesCommand : ::testing::Test, TwoTori {
  std::string o3 = write_obj(folder / "third.obj", ring(8, 1, {10, 0, 0}));

  [[nodiscard]] std::vector<std::string> bodies(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"bodies", o1, o2, o3};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] MultiBodyQuery in_library() const {
    return MultiBodyQuery(with_atlases(std::vector{read_mesh(o1), read_mesh(o2), read_mesh(o3)}, 64));
  }
};

TEST_F(BodiesCommand, PrintsThePairsOfTheLibrary) {
  const Outcome run = run_sdm(bodies({"--json", "--units", "mm"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  MultiBodyQuery expected = in_library();
  ASSERT_EQ(json["pairs"].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const PairSeparation& pair = expected.separations()[i];
    EXPECT_EQ(json["pairs"][i]["first"], pair.first);
    EXPECT_EQ(json["pairs"][i]["second"], pair.second);
    EXPECT_EQ(json["pairs"][i]["separation"]["value"], pair.separation.value);
    EXPECT_EQ(json["pairs"][i]["separation"]["lower"], pair.separation.lower);
    EXPECT_EQ(json["pairs"][i]["separation"]["kind"], "exact");
    EXPECT_EQ(json["pairs"][i]["colliding"]["value"], pair.colliding);
    EXPECT_EQ(json["pairs"][i]["penetration_depth"]["upper"],
              i == 0 ? expected.penetration_depths()[0].penetration_depth.upper : 0);
  }
  EXPECT_EQ(json["pairs"][0]["colliding"]["value"], true);
  EXPECT_EQ(json["pairs"][1]["colliding"]["value"], false);
  EXPECT_EQ(json["candidate_pairs"], 3);
  EXPECT_EQ(json["bodies"][2]["file"], o3);
  EXPECT_EQ(json["units"], "mm");
  EXPECT_FALSE(json.contains("resolution"));
  EXPECT_TRUE(json["max_distance"].is_null());
  for (const char* step : {"import", "build", "query"}) EXPECT_GT(json["time_ms"][step], 0) << step;
  EXPECT_EQ(run.err, "") << "progress is for terminals";
}

TEST_F(BodiesCommand, PlacesBodiesOfOneFileByPoses) {
  const auto poses = [&](const std::string& text) {
    const std::string file = folder / "poses.txt";
    std::ofstream(file) << text;
    return file;
  };
  const auto arguments = [&](const std::string& file) {
    return std::vector<std::string>{"bodies", o1, o1, "--poses", file, "--json", "--contact-margin", "0.05"};
  };
  // By x y z and a quaternion, and by a matrix: 90° about the Z axis.
  const Outcome run = run_sdm(arguments(
      poses("# two poses\n0 0 0  1 0 0 0\n\n0, -1, 0, 1.2,  1, 0, 0, 0.1,  0, 0, 1, 0.3  # 12 numbers\n")));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  const Shape shape(read_mesh(o1));
  ProximityQuery expected(shape, shape, {.contact_margin = 0.05});
  expected.set_pose(1, Transform::translation({1.2, 0.1, 0.3}) * Transform::rotation({0, 0, 90}));
  EXPECT_EQ(json["pairs"][0]["separation"]["value"], expected.separation().value);
  EXPECT_EQ(json["pairs"][0]["penetration_depth"]["lower"], expected.penetration_depth()->lower);
  ASSERT_EQ(json["contacts"].size(), expected.contacts().size());
  ASSERT_GT(json["contacts"].size(), 0u);
  for (std::size_t i = 0; i < expected.contacts().size(); ++i) {
    EXPECT_EQ(json["contacts"][i]["depth"], expected.contacts()[i].depth);
    for (std::size_t body = 0; body < 2; ++body)
      EXPECT_EQ(json["contacts"][i]["faces"][body], expected.contacts()[i].on[body].face);
    EXPECT_EQ(json["contacts"][i]["id"], expected.contacts()[i].id);
    EXPECT_EQ(json["contacts"][i]["second"], 1);
  }
  const auto refusal = [&](const std::string& text) {
    const Outcome refused = run_sdm(arguments(poses(text)));
    EXPECT_EQ(refused.code, 1);
    EXPECT_EQ(refused.out, "");
    return refused.err;
  };
  EXPECT_THAT(refusal("0 0 0 1 0 0 0\n"), HasSubstr("poses.txt: 1 poses for 2 bodies"));
  EXPECT_THAT(refusal("0 0 0 1 0 0 0\n0 0 0\n"), HasSubstr("poses.txt: line 2: 3 numbers"));
  EXPECT_THAT(refusal("0 0 zero 1 0 0 0\n"), HasSubstr("line 1: zero is not a number"));
  EXPECT_THAT(refusal("0 0 0 0 0 0 0\n"), HasSubstr("line 1: a quaternion"));
  EXPECT_THAT(refusal("0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0"), HasSubstr("line 3: more poses"));
  EXPECT_THAT(refusal("0 0 0 1 0 0 0\n1 1 0 0 0 1 0 0 0 0 1 0\n"),
              HasSubstr("body 1: a pose is not a rotation"));
  EXPECT_THAT(run_sdm(arguments(folder / "none.txt")).err, HasSubstr("none.txt: there is no such file"));
}

TEST_F(BodiesCommand, LeavesOutWhatIsFar) {
  Outcome run = run_sdm(bodies({"--json", "--max-distance", "2"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  ASSERT_EQ(json["pairs"].size(), 1u);
  EXPECT_EQ(json["pairs"][0]["second"], 1);
  EXPECT_EQ(json["max_distance"], 2);
  run = run_sdm(bodies({"--max-distance", "2"}));
  EXPECT_THAT(run.out, HasSubstr("  0      1       yes (exact)"));
  EXPECT_THAT(run.out, Not(HasSubstr("  0      2")));
  run = run_sdm(bodies());
  EXPECT_THAT(run.out, HasSubstr("  0      2       no (exact)   "));
  EXPECT_EQ(run_sdm(bodies({"--quiet"})).out, "");
}

TEST_F(BodiesCommand, TellsOfPairsWithoutASolid) {
  const std::string open =
      write_obj(folder / "open.obj", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}});
  EXPECT_THAT(run_sdm({"bodies", open, open}).out, HasSubstr("none: no solid"));
  const Json json = Json::parse(run_sdm({"bodies", open, open, "--json"}).out);
  EXPECT_TRUE(json["pairs"][0]["penetration_depth"].is_null());
}

TEST_F(BodiesCommand, WritesAMapForEachBody) {
  const Outcome run = run_sdm(bodies({"-o", out, "--resolution", "64", "--max-distance", "9", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"0", "1", "2", "report.json"}));
  EXPECT_EQ(contents(out + "/report.json"), run.out);
  const MultiBodyQuery expected = in_library();
  for (std::size_t body = 0; body < 3; ++body) {
    const std::string mine = out + "/" + std::to_string(body);
    EXPECT_EQ(names_in(mine),
              (std::vector<std::string>{"atlas_direction.png", "atlas_distance.png", "atlas_voronoi.png",
                                        "body.npy", "map.exr", "model.glb"}));
    const NearestMap nearest = expected.nearest_map(body, 9);
    const std::string bytes = contents(mine + "/body.npy");
    std::vector<std::uint32_t> written(nearest.map.texels());
    ASSERT_EQ(bytes.size(), 128 + 4 * written.size());
    std::memcpy(written.data(), bytes.data() + 128, 4 * written.size());
    EXPECT_TRUE(std::equal(written.begin(), written.end(), nearest.body.begin()));
    write_exr(folder / "expected.exr", expected.surface(body), nearest.map);
    EXPECT_TRUE(same_contents("map.exr", contents(mine + "/map.exr"), contents(folder / "expected.exr")));
  }
  EXPECT_THAT(run_sdm(bodies({"-o", out})).out, HasSubstr(out));
}

TEST_F(BodiesCommand, RefusesWhatItCannotUse) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--max-distance", "0"},
                                               {"--max-distance", "inf"},
                                               {"--resolution", "8"},
                                               {"--unknown"},
                                               {"-o", ""}})
    EXPECT_EQ(run_sdm(bodies(more)).code, 2) << more[0];
  EXPECT_EQ(run_sdm({"bodies"}).code, 2);
  EXPECT_EQ(run_sdm({"bodies", o1}).code, 2);
  Outcome run = run_sdm({"bodies", o1, folder / "none.obj", "-o", out});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.obj"));
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(out));
  run = run_sdm(bodies({"-o", o1}));
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("it is not a folder"));
}

}  // namespace
}  // namespace sdm::test
