// Places, islands and shares, as `sdm map` and `sdm points` state them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/points.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
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

/// A plate of 10 x 10 at z = 0 in two named halves, and clouds of it.
struct PlacesOutput : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out", plate = folder / "plate.obj";
  std::mt19937 random{1};

  PlacesOutput() {
    std::ofstream(plate) << "v 0 0 0\nv 5 0 0\nv 10 0 0\nv 0 10 0\nv 5 10 0\nv 10 10 0\n"
                            "g left\nf 1 2 5 4\ng right\nf 2 3 6 5\n";
  }
  double any(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }

  /// 20000 points with two bumps: 0.5 high at (2, 2), 0.3 deep at (8, 8); and `floating` points far above.
  std::string cloud(int floating) {
    std::string text;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p{any(0, 10), any(0, 10), 0};
      const double up = std::hypot(p[0] - 2, p[1] - 2), down = std::hypot(p[0] - 8, p[1] - 8);
      const double z = up < 0.8 ? 0.5 * (1 - up * up) : down < 0.8 ? -0.3 * (1 - down * down) : 0;
      text += fmt::format("{:.6} {:.6} {:.6}\n", p[0], p[1], z);
    }
    for (int i = 0; i < floating; ++i)
      text += fmt::format("{:.6} {:.6} {:.6}\n", any(0, 10), any(0, 10), any(4, 9));
    std::ofstream(folder / "cloud.xyz") << text;
    return folder / "cloud.xyz";
  }
  Outcome points(const std::string& file, std::vector<std::string> more) const {
    more.insert(more.begin(), {"points", file, plate, "-o", out, "--sign", "side"});
    return run_sdm(more);
  }
};

TEST_F(PlacesOutput, OfACloudAreClustersBeforeFloatingPoints) {
  const Outcome run = points(cloud(60), {"--tolerance", "0.1", "--json"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json places = Json::parse(run.out)["places"];
  EXPECT_EQ(places["limits_from"], "tolerance");
  EXPECT_EQ(places["large"]["count"], 2);
  EXPECT_GT(places["small"]["count"], 40);
  EXPECT_EQ(places["small"]["points"], 60);
  const Json& largest = places["largest"];
  ASSERT_EQ(largest.size(), 10u);
  EXPECT_NEAR(largest[0]["distance"], 0.5, 0.05);
  EXPECT_NEAR(largest[0]["point"][0], 2, 0.5);
  EXPECT_EQ(largest[0]["group"], "left");
  EXPECT_NEAR(largest[1]["distance"], -0.3, 0.05);
  EXPECT_EQ(largest[1]["group"], "right");
  EXPECT_EQ(largest[1]["at"], "point");
  EXPECT_FALSE(largest[1]["small"]);
  EXPECT_TRUE(largest[2]["small"]);
  EXPECT_THAT(points(folder / "cloud.xyz", {"--tolerance", "0.1"}).out,
              HasSubstr("places    2 out of tolerance"));
}

TEST_F(PlacesOutput, IslandsOfACloudCountForNothing) {
  const std::string with = cloud(60);
  const Outcome run = points(with, {"--tolerance", "0.6", "--ignore-islands", "10", "--json"});
  EXPECT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  const Json& islands = report["o1"]["ignored_islands"];
  EXPECT_EQ(islands["points"], 60);
  EXPECT_GT(islands["islands"], 40);
  EXPECT_EQ(report["points_with_value"], 20000);
  EXPECT_LT(report["distance"]["max"], 0.6);
  EXPECT_EQ(report["beyond_max_distance"], 0);
  EXPECT_THAT(report["notes"].dump(), HasSubstr("with 60 points"));
  EXPECT_EQ(points(with, {"--tolerance", "0.6"}).code, 3);
  for (const char* bad : {"0", "0x10", "-3", "2.5", ""})
    EXPECT_EQ(points(with, {std::string("--ignore-islands=") + bad}).code, 2) << bad;
}

// A point without a value has no place in the numbers: the line says why it fails.
TEST_F(PlacesOutput, PointsWithoutAValueAreTheReasonAndAPlace) {
  const Outcome run = points(cloud(60), {"--tolerance", "0.6", "--max-distance", "1"});
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.out,
              HasSubstr("tolerance FAIL: 0.2991 % of the points have no value, as a point is farther "
                        "than the maximum distance\n"));
  EXPECT_THAT(run.out, HasSubstr(" small ones out of tolerance (below "));
  EXPECT_THAT(run.out, HasSubstr("            no value at ("));
  const Outcome with_json =
      points(folder / "cloud.xyz", {"--tolerance", "0.6", "--max-distance", "1", "--json"});
  const Json places = Json::parse(with_json.out)["places"];
  EXPECT_EQ(places["small"]["points"], 60);
  EXPECT_TRUE(places["largest"][0]["distance"].is_null());
  EXPECT_EQ(
      points(folder / "cloud.xyz", {"--tolerance", "0.6", "--max-distance", "1", "--ignore-islands", "10"})
          .code,
      0)
      << "islands have no value, and lack none";
}

TEST_F(PlacesOutput, AreOutOfTheLimitsOfTheirGroups) {
  std::ofstream(folder / "table.csv") << "group,lower,upper\nleft,-0.6,0.6\nright,-0.1,0.1\n";
  const Outcome run = points(cloud(0), {"--tolerance-table", folder / "table.csv", "--json"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json places = Json::parse(run.out)["places"];
  EXPECT_EQ(places["limits_from"], "tolerance");
  EXPECT_TRUE(places["lower"].is_null());
  ASSERT_EQ(places["large"]["count"], 1);
  EXPECT_EQ(places["largest"][0]["group"], "right");
  EXPECT_EQ(places["largest"][0]["upper"], 0.1);
  const std::string bumpy = folder / "bumpy.obj";
  std::ofstream(bumpy) << "v 0 0 0.5\nv 5 0 0\nv 10 0 0.3\nv 0 10 0\nv 5 10 0\nv 10 10 0\n"
                          "g left\nf 1 2 5 4\ng right\nf 2 3 6 5\n";
  const Outcome map = run_sdm({"map", bumpy, plate, "-o", out, "--resolution", "64", "--write", "none",
                               "--tolerance-table", folder / "table.csv"});
  EXPECT_EQ(map.code, 3) << map.err;
  EXPECT_THAT(map.out, HasSubstr("places    1 out of tolerance, with "));
  EXPECT_THAT(map.out, HasSubstr("            0.3 at (10 0 0.3), "));
}

// Neither for the alignment nor for the coverage of O2.
TEST_F(PlacesOutput, IslandsOfACloudAreNotSampled) {
  const std::string part =
      write_obj(folder / "part.obj", joined(sphere(3), moved(square(0.5, 0), {0, 0, 9})));
  std::string scan, islands;
  for (const Vec3& p : sphere(4).positions) scan += fmt::format("{} {} {}\n", p[0] + 0.02, 1.01 * p[1], p[2]);
  for (int i = 0; i < 5; ++i) islands += fmt::format("0 0.{} 9.01\n", i);
  const auto report = [&](const std::string& text, std::vector<std::string> more) {
    std::ofstream(folder / "scan.xyz") << text;
    more.insert(more.begin(), {"points", folder / "scan.xyz", part, "-o", out, "--tolerance", "0.2", "--json",
                               "--min-coverage", "0", "--align"});
    const Outcome run = run_sdm(more);
    EXPECT_LE(run.code, 5) << run.err;
    EXPECT_NE(run.code, 1) << run.err;
    return Json::parse(run.out);
  };
  const Json clean = report(scan, {}), with = report(islands + scan, {"--ignore-islands", "6"}),
             all = report(islands + scan, {});
  EXPECT_EQ(with["o1"]["ignored_islands"]["points"], 5);
  EXPECT_EQ(with["alignment"]["matrix"], clean["alignment"]["matrix"]);
  EXPECT_EQ(with["coverage"], clean["coverage"]);
  EXPECT_NE(all["alignment"]["matrix"], clean["alignment"]["matrix"]);
  EXPECT_GT(all["coverage"]["value"], clean["coverage"]["value"]);
}

TEST_F(PlacesOutput, ACloudOfIslandsIsNotDecided) {
  std::ofstream(folder / "few.xyz") << "1 1 0\n2 2 0\nnan nan nan\n";
  const Outcome run = points(folder / "few.xyz", {"--tolerance", "0.1", "--ignore-islands", "9", "--json"});
  EXPECT_EQ(run.code, 4) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["tolerance"]["text"], "no point is left to measure");
  EXPECT_EQ(report["tolerance"]["exceeded_point_fraction"], 0);
  EXPECT_EQ(report["colors"]["range"], Json({0.0, 0.2})) << "no accuracy, but limits";
  EXPECT_THAT(report["notes"].dump(), HasSubstr("left out; there are no other points with coordinates"));
  EXPECT_THAT(points(folder / "few.xyz", {"--ignore-islands", "9", "--align"}).err,
              HasSubstr("there are no points with coordinates that are of no island"));
}

// An uneven placement stretches some lengths more than others.
TEST_F(PlacesOutput, TheReachOfIslandsHoldsAfterThePlacement) {
  const std::string file = cloud(60);
  const auto found = [&](const std::string& placement) {
    const Json report = Json::parse(
        points(file, {"--ignore-islands", "10", "--write", "none", "--json", "--transform-o1", placement})
            .out);
    EXPECT_EQ(report["o1"]["ignored_islands"]["points"], 60);
    return report["o1"]["ignored_islands"]["reach"].get<double>();
  };
  const PointIslands plain = CloudIslands(file, 10).found();
  EXPECT_EQ(plain.points, 60u);
  EXPECT_DOUBLE_EQ(plain.reach, 2 * std::sqrt(3.0) * plain.apart);
  EXPECT_DOUBLE_EQ(found("scale:2"), 2 * plain.reach);
  Transform uneven;
  uneven.rows[0][0] = 10;
  uneven.rows[2][2] = 0.5;
  const PointIslands placed = CloudIslands(file, 10).found(uneven);
  EXPECT_DOUBLE_EQ(placed.reach, 10 * plain.reach);
  EXPECT_DOUBLE_EQ(placed.apart, 0.5 * plain.apart);
  // A shear: bounds of its stretches, 1.618 and 0.618.
  Transform shear;
  shear.rows[0][1] = 1;
  const PointIslands sheared = CloudIslands(file, 10).found(shear);
  EXPECT_GE(sheared.reach, 1.618 * plain.reach);
  EXPECT_LE(sheared.reach, 1.8 * plain.reach);
  EXPECT_LE(sheared.apart, 0.6181 * plain.apart);
  EXPECT_GE(sheared.apart, 0.55 * plain.apart);
}

// Points without coordinates are no part of any fraction.
TEST_F(PlacesOutput, FractionsAreOfThePointsWithCoordinates) {
  std::ofstream(folder / "some.xyz") << "1 1 0\n2 2 0.3\n3 3 0\n4 4 7\nnan nan nan\nnan 1 1\n";
  const Outcome run = points(folder / "some.xyz", {"--tolerance", "0.1", "--max-distance", "1", "--json"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["tolerance"]["exceeded_points"], 2);
  EXPECT_EQ(report["tolerance"]["exceeded_point_fraction"], 0.5);
  EXPECT_EQ(report["beyond_max_distance_point_fraction"], 0.25);
}

// As directions without a measurement in a scan with coordinates of a country are: at 0, 0, 0.
TEST_F(PlacesOutput, IslandsFarAwayAreLeftOutInAnyOrder) {
  // More points apart than there may be cells, which therefore are widened.
  constexpr int kSide = 65;
  std::string scan, far;
  for (int i = 0; i < kSide * kSide * kSide; ++i)
    scan +=
        fmt::format("{} {} {}\n", 0.16 * (i % kSide), 0.16 * (i / kSide % kSide), 0.16 * (i / kSide / kSide));
  for (const char* away : {"1.7e6", "1.7e10", "1.7e201"})  // 1e5, 1e9 and 1e200 diagonals
    for (int i = 0; i < 5; ++i) far += fmt::format("-{} {} -{}\n", away, away, away);
  for (const std::string& text : {scan + far, far + scan}) {
    std::ofstream(folder / "far.xyz") << text;
    const Outcome run = points(folder / "far.xyz", {"--ignore-islands", "10", "--write", "none", "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json report = Json::parse(run.out);
    EXPECT_EQ(report["o1"]["ignored_islands"]["points"], 15);
    EXPECT_EQ(report["o1"]["ignored_islands"]["islands"], 3);
    EXPECT_EQ(report["points_with_value"], kSide * kSide * kSide);
    EXPECT_NEAR(report["distance"]["max"], 0.16 * (kSide - 1), 0.5);
  }
}

TEST_F(PlacesOutput, GroupsOfTheReferenceJudgeACloud) {
  std::ofstream(folder / "table.csv") << "group,lower,upper\nleft,-0.1,0.6\nright,-0.1,0.1\n";
  const Outcome run = points(cloud(0), {"--tolerance-table", folder / "table.csv", "--json"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json all = Json::parse(run.out)["group_tolerances"];
  EXPECT_EQ(all["verdict"], "FAIL");
  ASSERT_EQ(all["groups"].size(), 2u);
  const Json &left = all["groups"][0], &right = all["groups"][1];
  EXPECT_EQ(left["verdict"], "PASS") << "-0.5 would be out, but points that are so far have the other side";
  EXPECT_EQ(left["reason"], "all within");
  EXPECT_EQ(right["verdict"], "FAIL");
  EXPECT_NEAR(right["lowest"], -0.3, 0.05);
  EXPECT_EQ(left["points"].get<int>() + right["points"].get<int>(), 20000);
  EXPECT_GT(right["exceeded_point_fraction"], 0.01);
  EXPECT_THAT(points(folder / "cloud.xyz", {"--tolerance-table", folder / "table.csv"}).out,
              HasSubstr("of its points are out"));
  std::ofstream(folder / "lid.csv") << "group,lower,upper\nlid,-0.1,0.6\n";
  EXPECT_THAT(points(folder / "cloud.xyz", {"--tolerance-table", folder / "lid.csv"}).err,
              HasSubstr("has the name 'lid'; its names are left, right"));
}

// What is beyond the maximum distance, as where a part is missing, is of no group, but a defect nevertheless.
TEST_F(PlacesOutput, PointsOfNoGroupFail) {
  std::ofstream(folder / "table.csv") << "group,lower,upper\nleft,-0.6,0.6\nright,-0.6,0.6\n";
  const auto run = [&](const std::string& file, std::vector<std::string> more) {
    more.insert(more.end(), {"--tolerance-table", folder / "table.csv"});
    return points(file, more);
  };
  const std::string file = cloud(60);
  const Outcome json = run(file, {"--max-distance", "1", "--json"});
  EXPECT_EQ(json.code, 3) << json.err;
  const Json all = Json::parse(json.out)["group_tolerances"];
  EXPECT_EQ(all["verdict"], "FAIL");
  EXPECT_EQ(all["reason"], "beyond max distance");
  EXPECT_EQ(all["text"],
            "60 points are of no group, as the reference is farther than the maximum distance (1)");
  EXPECT_EQ(all["beyond_max_distance"], 60);
  EXPECT_EQ(all["without_match"], 0);
  for (const Json& group : all["groups"]) EXPECT_EQ(group["verdict"], "PASS");
  EXPECT_THAT(
      run(file, {"--max-distance", "1", "--accept-doubts"}).out,
      AllOf(HasSubstr("FAIL: "), HasSubstr("  groups    FAIL: 60 points are of no group, as the reference is "
                                           "farther than the maximum distance (1)\n")));
  const Outcome islands = run(file, {"--max-distance", "1", "--ignore-islands", "10", "--json"});
  EXPECT_EQ(islands.code, 0) << "islands are not judged";
  EXPECT_EQ(Json::parse(islands.out)["group_tolerances"]["reason"], nullptr);

  std::ofstream(folder / "normals.xyz") << "x y z nx ny nz\n2 2 0.1 0 0 1\n3 3 0.1 0 0 -1\n";
  const Outcome facing = run(folder / "normals.xyz", {"--facing", "60"});
  EXPECT_EQ(facing.code, 3) << facing.err;
  EXPECT_THAT(facing.out,
              HasSubstr("FAIL: 1 point is of no group, as no face of the reference faces the same way\n"));
}

// Points beside an open reference have no side: only |d| is known.
TEST_F(PlacesOutput, OneSidedTolerancesOfCloudsNeedSigns) {
  std::ofstream(folder / "beside.xyz") << "5 5 0.1\n5 10.3 0.2\n";
  const auto verdict = [&](const std::string& tolerance) {
    return Json::parse(
        points(folder / "beside.xyz", {"--tolerance=" + tolerance, "--json"}).out)["tolerance"];
  };
  EXPECT_EQ(verdict("-1:0.2")["verdict"], "NOT DECIDED");
  EXPECT_EQ(verdict("-1:0.2")["reason"], "estimated signs");
  EXPECT_EQ(verdict("-0.2:0.2")["verdict"], "FAIL");
  EXPECT_EQ(verdict("-1:0.05")["verdict"], "FAIL");
  EXPECT_EQ(verdict("-1:1")["verdict"], "PASS");
}

TEST_F(PlacesOutput, TheShareBeyondTheMaximumDistanceIsStated) {
  const Outcome run = points(cloud(5), {"--max-distance", "1", "--json"});
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["beyond_max_distance"], 5);
  EXPECT_NEAR(report["beyond_max_distance_point_fraction"], 5.0 / 20005, 1e-12);
  const std::string high = write_obj(folder / "high.obj", square(3, 2));
  const std::vector<std::string> map{"map", plate,          high,  "-o",      out,   "--max-distance",
                                     "3",   "--resolution", "128", "--write", "none"};
  std::vector<std::string> json = map;
  json.emplace_back("--json");
  const Json shares = Json::parse(run_sdm(json).out);
  const double share = shares["beyond_max_distance_area_fraction"];
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.95);
  EXPECT_THAT(run_sdm(map).out, HasSubstr(fmt::format("{:.5g} % of the area, are farther", 100 * share)));
}

TEST_F(PlacesOutput, IslandsOfTheReferenceAttractNothing) {
  // A speck of one face floats above the plate, nearer to O1 than the plate is.
  const std::string o1 = write_obj(folder / "o1.obj", square(2, 0.5)), o2 = folder / "o2.obj";
  write_obj(o2, joined(joined(square(3, 0), square(3, -4)), moved(single_triangle(), {0, 0, 0.6})));
  const std::vector<std::string> map{"map",          o1,   o2,        "-o",   out,
                                     "--resolution", "64", "--write", "none", "--json"};
  std::vector<std::string> without = map;
  without.insert(without.end(), {"--ignore-islands-o2", "2"});
  EXPECT_LT(Json::parse(run_sdm(map).out)["distance"]["min"], 0.45);
  const Outcome run = run_sdm(without);
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_NEAR(report["distance"]["min"], 0.5, 1e-5);
  EXPECT_NEAR(report["distance"]["max"], 0.5, 1e-5);
  EXPECT_EQ(report["o2"]["ignored_islands"]["islands"], 1);
  EXPECT_THAT(report["notes"].dump(), HasSubstr("o2.obj: 1 island with 1 face"));
}

}  // namespace
}  // namespace sdm::test
