#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/mesh_attributes.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <cstdint>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/error_of.h"
#include "support/run_sdm.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using test::error_of;
using test::run_sdm;
using ::testing::HasSubstr;
using ::testing::Not;

// A cube with named faces, and one that is higher by 0.1: the top is up to 0.1 inside it, the rest on it.
class GroupTolerancesOption : public testing::Test {
 protected:
  GroupTolerancesOption() {
    write_cube(part, 1);
    write_cube(higher, 1.1);
  }

  static void write_cube(const std::string& file, double height) {
    std::ofstream out(file);
    for (const double z : {0.0, height})
      for (const char* xy : {"0 0", "1 0", "1 1", "0 1"}) out << "v " << xy << ' ' << z << '\n';
    out << "g bottom\nf 1 4 3 2\ng top, red\nf 5 6 7 8\ng sides\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 "
           "8\n";
  }
  std::string table(const std::string& text, const std::string& name = "table.csv") const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  test::Outcome map(const std::string& file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{
        "map", part, higher, "-o", out, "--resolution", "64", "--write", "none", "--tolerance-table", file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }

  const test::TemporaryFolder folder;
  const std::string part = folder / "part.obj", higher = folder / "higher.obj", out = folder / "out";
};

// The sides and the bottom are 5 of 6 equal faces.
TEST_F(GroupTolerancesOption, ANoteStatesTheAreaThatIsNotJudged) {
  const std::string file = table("group,lower,upper\n\"top, red\",-0.2,0.2\n");
  const std::string note = part + " has no limits and is not judged";
  const test::Outcome outcome = map(file);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("note      83.3 % of the area of " + note));
  EXPECT_THAT(map(file, {"--tolerance", "0.2"}).out, Not(HasSubstr(note)));
}

TEST_F(GroupTolerancesOption, JudgesEachGroupAndTakesTheWorst) {
  const std::string file = table("group,lower,upper\nbottom,-0.001,0.001\n\"top, red\",-0.05,0.05\n");
  const test::Outcome outcome = map(file, {"--json"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out, nullptr, false);
  const auto& all = report["group_tolerances"];
  EXPECT_EQ(all["verdict"], "FAIL");
  ASSERT_EQ(all["groups"].size(), 2u);
  const auto &bottom = all["groups"][0], &top = all["groups"][1];
  EXPECT_EQ(bottom["group"], "bottom");
  EXPECT_EQ(bottom["kind"], "group");
  EXPECT_EQ(bottom["verdict"], "PASS");
  EXPECT_EQ(bottom["certified"], true);
  EXPECT_EQ(bottom["triangles"], 2);
  EXPECT_EQ(top["verdict"], "FAIL");
  EXPECT_NEAR(top["lowest"].get<double>(), -0.1, 1e-6);
  EXPECT_GT(top["exceeded_area_fraction"], 0.5);
  EXPECT_FALSE(report.contains("tolerance") && !report["tolerance"].is_null());

  const auto facing = nlohmann::json::parse(map(file, {"--json", "--facing"}).out, nullptr, false);
  for (const auto& group : facing["group_tolerances"]["groups"]) EXPECT_EQ(group["certified"], true) << group;
  EXPECT_EQ(facing["group_tolerances"]["groups"][0]["verdict"], "PASS");

  const std::string text = map(file).out;
  EXPECT_THAT(text, HasSubstr("  groups    FAIL\n"));
  EXPECT_THAT(text, HasSubstr("bottom (group): PASS, ±0.001"));
  EXPECT_THAT(text, HasSubstr("top, red (group): FAIL, ±0.05"));
}

TEST_F(GroupTolerancesOption, PassesWhereEachGroupDoes) {
  const std::string csv = table("group,lower,upper\n\"top, red\",-0.11,0.01\nsides,-0.001,0.001\n");
  EXPECT_EQ(map(csv).code, 0);
  const std::string json = table(R"([{"group": "top, red", "lower": -0.11, "upper": 0.01}])", "table.json");
  EXPECT_EQ(map(json).code, 0);
  // The tolerance of all faces is judged too.
  EXPECT_EQ(map(json, {"--tolerance", "0.05"}).code, 3);
}

// The limit is exceeded by less than the accuracy of the engine.
TEST_F(GroupTolerancesOption, WithinTheAccuracyNothingIsDecided) {
  const test::Outcome outcome = map(table("group,lower,upper\n\"top, red\",-0.0999999,0.01\n"), {"--json"});
  EXPECT_EQ(outcome.code, 4);
  const auto group = nlohmann::json::parse(outcome.out, nullptr, false)["group_tolerances"]["groups"][0];
  EXPECT_EQ(group["verdict"], "NOT DECIDED");
  EXPECT_LT(group["undecided_by"], 1e-5);
}

TEST_F(GroupTolerancesOption, UnknownGroupsAreNamed) {
  const test::Outcome outcome = map(table("group,lower,upper\nlid,-1,1\n"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("has the name 'lid'; its names are"));
  EXPECT_THAT(outcome.err, HasSubstr("its names are bottom, top, red, sides"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

// A part whose group was left out as an island would pass.
TEST_F(GroupTolerancesOption, AGroupWithoutFacesIsUnknown) {
  std::ofstream(part, std::ios::app) << "v 9 9 9\nv 9 9.01 9\nv 9.01 9 9\ng speck\nf 9 10 11\n";
  const std::string file = table("group,lower,upper\nspeck,-0.1,0.1\n");
  EXPECT_EQ(map(file).code, 3);
  const test::Outcome outcome = map(file, {"--ignore-islands", "2"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("has the name 'speck'"));
}

// The other mesh has the group: this one is not judged.
TEST_F(GroupTolerancesOption, BothMeshesAreJudgedByTheGroupsThatTheyHave) {
  std::ofstream(higher, std::ios::app) << "v 0.5 0.5 1.1\nv 0.6 0.5 1.1\nv 0.5 0.6 1.1\ng mark\nf 9 10 11\n";
  const test::Outcome outcome = map(table("group,lower,upper\nmark,-0.2,0.2\n"), {"--both", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(report["o1"].contains("group_tolerances"));
  EXPECT_EQ(report["o2"]["group_tolerances"]["verdict"], "PASS");
}

TEST_F(GroupTolerancesOption, TablesAreChecked) {
  const auto fault = [&](const std::string& text) {
    const std::string file = table(text);
    return error_of([&] { (void)read_tolerance_table(file); });
  };
  EXPECT_THAT(fault("name,min,max\na,1,2\n"), HasSubstr("table.csv: a table of tolerances has the header"));
  EXPECT_THAT(fault("group,lower,upper\n"), HasSubstr("has no rows"));
  EXPECT_THAT(fault("group,lower,upper\na,1,x\n"), HasSubstr("line 2: 'x' is not a finite number"));
  EXPECT_THAT(fault("group,lower,upper\n\na,2,1\n"),
              HasSubstr("line 3: the lower limit 2 is above the upper one, 1"));
  EXPECT_THAT(fault("group,lower,upper\na,1\n"), HasSubstr("line 2: has 2 fields"));
  EXPECT_THAT(fault("group,lower,upper\na,1,2\na,1,3\n"), HasSubstr("group a has two rows"));
  EXPECT_THAT(fault("group,lower,upper\n,1,2\n"), HasSubstr("the group has no name"));
  EXPECT_THAT(fault("group,lower,upper\na,-inf,2\n"), HasSubstr("'-inf' is not a finite number"));
  EXPECT_THAT(fault("[{\"group\": \"a\", \"lower\": \"1\", \"upper\": 2}]"), HasSubstr("row 1"));
  EXPECT_THAT(fault("[{\"group\": \"a\", \"lower\": null}]"), HasSubstr("row 1: group a has no limit"));
  EXPECT_THAT(fault("group,lower,upper\na,,\n"), HasSubstr("line 2: group a has no limit"));
  EXPECT_THAT(fault("group,lower,upper\na,-0,1,0,1\n"), HasSubstr("line 2: has 5 fields between ','"));
  EXPECT_THAT(fault("group;lower;upper\na;-0,1,5;1\n"), HasSubstr("'-0,1,5' is not a finite number"));
  EXPECT_THAT(fault("{}"), HasSubstr("JSON array"));
  EXPECT_THAT(error_of([&] { (void)read_tolerance_table(folder / "none.csv"); }),
              HasSubstr("there is no such file"));
  EXPECT_THAT(error_of([&] { (void)read_tolerance_table(folder.path()); }), HasSubstr("this is a folder"));
  EXPECT_THAT(fault(std::string("group,lower,upper\na\0b,1,2\n", 25)), HasSubstr("byte 0"));
  EXPECT_EQ(map("").code, 2) << "an unset variable of a script";
}

TEST_F(GroupTolerancesOption, TablesOfSpreadsheetsAndOpenSidesAreRead) {
  const auto rows = [&](const std::string& text) { return read_tolerance_table(table(text)); };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const std::vector<GroupTolerance> semicolons =
      rows("group;lower;upper\r\n\"a;b\";-0,1;0.05\r\nc;;0,06\r\n");
  ASSERT_EQ(semicolons.size(), 2u);
  EXPECT_EQ(semicolons[0].group, "a;b");
  EXPECT_EQ(semicolons[0].tolerance, Tolerance(-0.1, 0.05));
  EXPECT_EQ(semicolons[1].tolerance, Tolerance(-kNone, 0.06));
  EXPECT_EQ(rows("group,lower,upper\na,-0.1,\n")[0].tolerance, Tolerance(-0.1, kNone));
  EXPECT_EQ(rows("Group, Lower ,UPPER\nA,-0.1,\n")[0].group, "A");
  EXPECT_EQ(rows("[{\"group\": \"a\", \"upper\": 0.1}]")[0].tolerance, Tolerance(-kNone, 0.1));
}

// The top is 0.1 too high.
TEST_F(GroupTolerancesOption, AnOpenSideAcceptsAnyDistance) {
  const auto report = [&](const std::string& limits, int code) {
    const test::Outcome outcome = map(table("group,lower,upper\n\"top, red\"," + limits + "\n"), {"--json"});
    EXPECT_EQ(outcome.code, code) << limits << outcome.err;
    return nlohmann::json::parse(outcome.out)["group_tolerances"]["groups"][0];
  };
  const nlohmann::json passes = report(",0.01", 0), fails = report("-0.01,", 3);
  EXPECT_EQ(passes["verdict"], "PASS");
  EXPECT_TRUE(passes["certified"]);
  EXPECT_TRUE(passes["lower"].is_null());
  EXPECT_EQ(fails["verdict"], "FAIL");
  EXPECT_TRUE(fails["upper"].is_null());
  EXPECT_THAT(map(table("group,lower,upper\n\"top, red\",,0.2\n")).out,
              HasSubstr("top, red (group): PASS, at most 0.2"));
}

TEST_F(GroupTolerancesOption, AGroupOfNeitherMeshIsNamedWithBoth) {
  const test::Outcome outcome = map(table("group,lower,upper\nlid,-1,1\n"), {"--both"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr(part + " or " + higher + " has the name 'lid'; of " + part));
}

TEST_F(GroupTolerancesOption, ThinWallsAreNoted) {
  EXPECT_THAT(map(table("group,lower,upper\nbottom,-0.9,0.9\n")).out,
              HasSubstr("of O2's walls are thinner than"));
  EXPECT_THAT(map(table("group,lower,upper\nbottom,-0.2,0.2\n")).out,
              ::testing::Not(HasSubstr("of O2's walls are thinner than")));
}

// A tile may have faces of only one of two kinds that share a name.
TEST(GroupsOfParts, KeepTheKindThatTheirNameHasOnTheWhole) {
  const std::vector<FaceNames> names{{"group", {"a"}, {0, kNone, kNone}},
                                     {"material", {"a", "b"}, {kNone, 0, 1}}};
  const std::vector<GroupTolerance> table{{"a", 1}, {"b", 1}, {"c", 1}};
  const std::vector<GroupTolerance> of_whole = with_kinds(names, table);
  EXPECT_EQ(of_whole[0].kind, "group");
  EXPECT_EQ(of_whole[1].kind, "material");
  EXPECT_EQ(of_whole[2].kind, "");
  const std::vector<std::uint32_t> part{1, 2};
  const std::vector<FaceNames> of_part = names_of_part(names, part);
  EXPECT_EQ(faces_of_groups(of_part, table)[0].faces, std::vector<std::uint32_t>{0});
  EXPECT_TRUE(faces_of_groups(of_part, of_whole)[0].faces.empty());
  EXPECT_EQ(faces_of_groups(of_part, of_whole)[1].faces, std::vector<std::uint32_t>{1});
  GroupVerdicts first, second;
  first.groups.push_back({.kind = "group", .group = "a", .verdict = {{{}, 1, {}, 0, {}}, {}}});
  second.groups.push_back({.kind = "material", .group = "a", .verdict = {{{}, 1, {}, 0, {}}, {}}});
  second.groups[0].verdict.verdict = Verdict::fail;
  EXPECT_EQ(combined_groups(std::vector{first, second}, of_whole, false).verdict, Verdict::pass);
}

}  // namespace
}  // namespace sdm
