// What the pages answer at once: what fails, where, and how sure that is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "report/page_browser.h"
#include "report/page_fixture.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// Makes two groups of the faces of an OBJ file: the first half "ring", the others "sides".
void name_halves(const std::string& file) {
  std::string text = contents(file);
  const std::size_t faces = text.find("\nf "), middle = text.find("\nf ", faces + (text.size() - faces) / 2);
  text.insert(middle, "\ng sides");
  text.insert(faces, "\ng ring");
  std::ofstream(file) << text;
}

// Distances are from 1.6 to 2.4.
TEST_F(Page, StatesHowSureItIs) {
  map({"--resolution", "64"});
  EXPECT_TRUE(passes("isSure", page(), {"MEASURED", "nothing"}));
  map({"--resolution", "64", "--tolerance", "2.3"});
  EXPECT_TRUE(passes("isSure", page(), {"FAIL", "proven"}));
  map({"--resolution", "64", "--tolerance", "3"});
  EXPECT_TRUE(passes("isSure", page(), {"PASS", "proven"}));
  map({"--resolution", "64", "--tolerance", "2.3", "--fail-area", "1e-3"});
  EXPECT_TRUE(passes("isSure", page(), {"FAIL", "an estimate", "connected places"}));
  map({"--resolution", "64", "--tolerance", "2.3", "--fail-share", "1"});
  EXPECT_TRUE(passes("isSure", page(), {"PASS", "an estimate", "connected places"}));
  const Outcome walls = run_sdm({"thickness", o1, "-o", out, "--resolution", "64", "--min", "0.1"});
  ASSERT_EQ(walls.code, 0) << walls.err;
  EXPECT_TRUE(passes("isSure", page(), {"PASS", "an estimate"}));
}

TEST_F(Page, BandsAreThoseOfEachGroup) {
  name_halves(o1);
  const std::string table = folder / "table.csv";
  std::ofstream(table) << "group,lower,upper\nring,-3,3\nsides,-1,1.5\n";
  for (const char* tolerance : {"", "5"}) {
    std::vector<std::string> options{"--resolution", "128", "--tolerance-table", table, "--units", "mm"};
    if (*tolerance != '\0') options.insert(options.end(), {"--tolerance", tolerance});
    o2 = write_obj(folder / "base.obj", moved(cube(4), {0, 0, kHeight - 4}));
    map(options);
    EXPECT_TRUE(passes("bandsByGroup", page(), {"ring", "sides", "1.5"}));
    EXPECT_TRUE(passes("isSure", page(), {"FAIL", "proven"}));
  }
}

// Faces of a row for their group and one for their material have what both accept.
TEST_F(Page, LegendsHaveTheLimitsOfAllRowsOfAFace) {
  o2 = write_obj(folder / "base.obj", moved(cube(4), {0, 0, kHeight - 4}));  // with signs
  std::string text = contents(o1);
  text.insert(text.find("\nf "), "\nusemtl steel");
  std::ofstream(o1) << text;
  name_halves(o1);
  const std::string table = folder / "table.csv";
  std::ofstream(table) << "group,lower,upper\nring,-3,3\nsteel,-1,1.7\nsides,-1,1.5\n";
  map({"--resolution", "64", "--tolerance-table", table});
  EXPECT_TRUE(passes("legendOfGroup", page(), {"ring", "1.7"}));
  EXPECT_TRUE(passes("legendOfGroup", page(), {"sides", "1.5"}));
  std::ofstream(table) << "group,lower,upper\nring,-1,1.6\nsides,-1,1.6\n";
  map({"--resolution", "64", "--tolerance-table", table});
  EXPECT_TRUE(passes("legendOfGroup", page(), {"all", "1.6"}));
}

TEST_F(Page, SaysWhatNoGroupOfATableJudges) {
  o2 = write_obj(folder / "base.obj", moved(cube(4), {0, 0, kHeight - 4}));  // with signs
  name_halves(o1);
  const std::string table = folder / "table.csv";
  for (const auto& [rows, words] :
       {std::pair("ring,-3,3\n", "for every point that has a limit"), {"sides,-1,1.5\n", "proven"}}) {
    std::ofstream(table) << "group,lower,upper\n" << rows;
    map({"--resolution", "64", "--tolerance-table", table});
    const std::string verdict = *rows == 'r' ? "PASS" : "FAIL";
    EXPECT_TRUE(passes("isSure", page(), {verdict, words, "of the area has no limits and is not judged."}));
  }
  EXPECT_TRUE(passes("says", page(), {"Worst: +2.4", "in sides, for which -1 to 1.5 is allowed."}));
}

TEST_F(Page, KeepsTheColoursThatWereAskedFor) {
  name_halves(o1);
  const std::string table = folder / "table.csv";
  std::ofstream(table) << "group,lower,upper\nring,-3,3\n";
  EXPECT_EQ(map({"--resolution", "64", "--tolerance-table", table})["colors"]["by_group"], true);
  EXPECT_TRUE(passes("opensIn", page(), {"tolerance"}));
  EXPECT_EQ(
      map({"--resolution", "64", "--tolerance-table", table, "--colormap", "viridis"})["colors"]["by_group"],
      false);
  EXPECT_TRUE(passes("opensIn", page(), {"viridis"}));
}

TEST_F(Page, IsReadyWithItsPicture) {
  map({"--resolution", "64", "--tolerance", "2.3"});
  EXPECT_TRUE(passes("isReadyWithItsPicture", page()));
}

TEST_F(Page, LegendsAreNotCrowded) {
  map({"--resolution", "64", "--tolerance", "2.3", "--units", "cm"});
  EXPECT_TRUE(passes("spacesLegend", page()));
}

TEST_F(Page, SpeaksPlainly) {
  map({"--resolution", "64", "--tolerance", "2.3", "--align", "--accept-doubts"});
  EXPECT_TRUE(passes("speaksPlainly", page()));
}

TEST_F(Page, ListsWhereAPartIsNearestToItself) {
  const Outcome run =
      run_sdm({"self", o1, "-o", out, "--resolution", "64", "--write", "html", "--geodesic", "0.5"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(contents(out + "/report.json"));
  EXPECT_TRUE(passes("listsNearest", page(), {report["separation"]["value"].dump()}));
}

// The square sinks from 1 towards the torus, whose height is ±0.4.
TEST_F(Page, PlayersStateTheVerdict) {
  const std::filesystem::path moving = folder / "moving";
  std::filesystem::create_directory(moving);
  for (int i = 0; i < 4; ++i) write_obj(moving / fmt::format("{}.obj", i), square(8, 1 - 0.1 * i));
  const auto played = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"sequence", o1,        moving, "--resolution", "64",
                                       "--player", "--units", "mm",   "-o",           out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = run_sdm(arguments);
    EXPECT_TRUE(run.code == 0 || run.code == 3) << run.err;
    return out + "/player.html";
  };
  const std::string failing = played({"--tolerance", "1.35"});
  EXPECT_TRUE(
      passes("judgesFrames", failing,
             {"FAIL", "Out of the tolerance of 1.35 mm in 1 of 4 frames; worst in frame 0: 1.4 mm.", "0"}));
  EXPECT_TRUE(passes("isSure", failing, {"FAIL", "a frame with a place that is out was found"}));
  EXPECT_TRUE(passes("markBesideLegend", failing));
  EXPECT_TRUE(passes("charts", failing, {"Distance of part.obj", "Separation"}));
  EXPECT_TRUE(passes(
      "judgesFrames", played({"--tolerance", "2"}),
      {"PASS", "Within the tolerance of 2 mm in all 4 frames; nearest to a limit in frame 0: 1.4 mm.", "0"}));
  EXPECT_TRUE(passes("judgesFrames", played({}), {"nothing"}));
}

}  // namespace
}  // namespace sdm::test
