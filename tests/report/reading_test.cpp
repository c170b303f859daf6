// What a person reads on the page: colours and their legend, sections, numbers and lists.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sdm/summary.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <random>

#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/legend.h"
#include "report/page_browser.h"
#include "report/page_fixture.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// The ends of the range of the colours, as words.
std::vector<std::string> ends_of(const Json& range) {
  return {range[0].dump(), range[1].dump()};
}

TEST_F(Page, LegendNamesTheRangeOfTheReportAndCanBeRead) {
  Json report = map({"--resolution", "64", "--tolerance", "2.3", "--units", "mm"});
  std::vector<std::string> words = ends_of(report["colors"]["range"]);
  words.emplace_back("2.3");
  EXPECT_TRUE(passes("legend", page(), words));
  o1 = write_obj(folder / "a.obj", sphere(3));
  o2 = write_obj(folder / "b.obj", moved(sphere(3), {0.5, 0, 0}));
  report = map({"--resolution", "64"});
  EXPECT_EQ(report["colors"]["map"], "diverging");
  EXPECT_TRUE(passes("legend", page(), ends_of(report["colors"]["range"])));
  o2 = write_obj(folder / "b.obj", moved(sphere(3), {1.9, 0, 0}));
  report = map({"--resolution", "64"});
  EXPECT_EQ(report["colors"]["map"], "sequential");
  EXPECT_TRUE(passes("legend", page(), ends_of(report["colors"]["range"])));
}

// The page has the same rule for colours and their numbers as pictures have.
TEST_F(Page, ScalesAreThoseOfPictures) {
  map({"--resolution", "64"});
  std::mt19937 random(17);
  std::uniform_real_distribution<double> exponent(-6, 6), part(-1, 1);
  Json cases = Json::array();
  for (int i = 0; i < 400; ++i) {
    const double size = std::pow(10, exponent(random)), a = size * part(random), b = size * part(random);
    io::ColorScale scale{
        .lower = std::min(a, b), .upper = std::max(a, b), .accuracy = i % 3 == 0 ? 1e-3 * size : 0};
    const std::array maps{Colormap::viridis, Colormap::sequential, Colormap::diverging, Colormap::paper2006};
    scale.map = maps[i % 4];
    std::string mode = name_of(scale.map);
    if (scale.map == Colormap::diverging) {
      scale.upper = std::max(scale.upper, -scale.lower);
      scale.lower = -scale.upper;
    }
    if (i % 5 == 0) {
      const double lower = scale.lower + 0.3 * (scale.upper - scale.lower),
                   upper = lower + 0.2 * (scale.upper - scale.lower);
      scale.map = Colormap::viridis;
      scale.tolerance = Tolerance(lower, upper);
      mode = "tolerance";
      if (i % 15 == 5) scale.tolerance->lower = -kInfinity;
      if (i % 15 == 10) scale.tolerance->upper = kInfinity;
    }
    const Tolerance tolerance = scale.tolerance.value_or(Tolerance(0, 0));
    Json labels = Json::array(), distances = Json::array(), colors = Json::array();
    for (const io::ScaleLabel& label : io::scale_labels(scale))
      labels.push_back({{"value", label.value}, {"text", label.text}, {"limit", label.is_limit}});
    for (int k = 0; k < 40; ++k) {
      const double d = 1.2 * size * part(random);
      const io::Rgb c = scale(d);
      distances.push_back(d);
      colors.push_back({c.r, c.g, c.b});
    }
    cases.push_back({{"scale",
                      {{"mode", mode},
                       {"lo", scale.lower},
                       {"hi", scale.upper},
                       {"lower", tolerance.lower},
                       {"upper", tolerance.upper},
                       {"accuracy", scale.accuracy}}},
                     {"labels", labels},
                     {"distances", distances},
                     {"colours", colors}});
  }
  std::ofstream(folder / "scales.json") << cases.dump();
  EXPECT_TRUE(passes("scales", page(), {folder / "scales.json"}));
}

// A large square from -0.05 to 0.05, and a small one at 0.2 with 0.25 % of the area.
TEST_F(Page, HistogramHasBothLimits) {
  std::ofstream(o1) << "v -2 -2 -0.05\nv 2 -2 0.05\nv 2 2 0.05\nv -2 2 -0.05\nf 1 2 3 4\n"
                       "v -0.1 -0.1 0.2\nv 0.1 -0.1 0.2\nv 0.1 0.1 0.2\nv -0.1 0.1 0.2\nf 5 6 7 8\n";
  o2 = write_obj(folder / "ground.obj", square(8, 0));
  map({"--resolution", "256", "--sign", "side", "--tolerance", "0.1"});
  EXPECT_TRUE(passes("histogram", page(), {"-0.1", "0.1"}));
  map({"--resolution", "256", "--tolerance", "0.1"});
  EXPECT_TRUE(passes("histogram", page(), {"none", "0.1"})) << "no distance is negative";
}

TEST_F(Page, DistancesHaveOneNumberOfDecimals) {
  const std::string text = contents(o1), table = folder / "table.csv";
  std::ofstream(o1) << "g ring\n" << text;
  std::ofstream(table) << "group,lower,upper\nring,0,1\n";
  for (const char* resolution : {"64", "512"}) {
    const Json report =
        map({"--resolution", resolution, "--tolerance", "2.3", "--tolerance-table", table, "--units", "mm"});
    const double digits = 1 - std::floor(std::log10(report["error_bound"].get<double>()));
    EXPECT_TRUE(passes("decimals", page(), {fmt::format("{}", digits), "mm"}));
  }
}

TEST_F(Page, ListsScrollInside) {
  map({"--resolution", "128", "--tolerance", "2.3"});
  EXPECT_TRUE(passes("lists", page()));
}

TEST_F(Page, GroupsAreSeenWhenTheyAreChosen) {
  std::string text = contents(o1);
  const std::size_t faces = text.find("\nf "), middle = text.find("\nf ", faces + (text.size() - faces) / 2);
  text.insert(middle, "\ng sides");
  text.insert(faces, "\ng ring");
  std::ofstream(o1) << text;
  const std::string table = folder / "table.csv";
  std::ofstream(table) << "group,lower,upper\nring,0,1\nsides,0,1\n";
  map({"--resolution", "64", "--tolerance-table", table});
  EXPECT_TRUE(passes("choosesGroups", page()));
}

TEST_F(Page, LongTablesShowTheirFirstRows) {
  Mesh squares;
  for (int i = 0; i < 20; ++i) squares = joined(squares, moved(square(0.1, 0), {0.2 * i, 0, 0}));
  o1 = write_obj(folder / "squares.obj", squares);
  map({"--resolution", "128"});
  EXPECT_TRUE(passes("caps", page(), {"Components: largest", "20"}));
}

TEST_F(Page, SectionsAreFilled) {
  map({"--resolution", "128", "--up", "z"});
  EXPECT_TRUE(passes("cutsTorus", page()));
  o1 = write_obj(folder / "a.obj", sphere(4));
  o2 = write_obj(folder / "b.obj", moved(sphere(4), {0.5, 0, 0}));
  map({"--resolution", "128", "--up", "z"});
  EXPECT_TRUE(passes("cutsBoth", page()));
}

TEST_F(Page, SectionsOfOpenPartsAreNotFilled) {
  Mesh open = sphere(4);
  open.triangles.pop_back();
  o1 = write_obj(folder / "a.obj", open);
  o2 = write_obj(folder / "b.obj", sphere(4));
  map({"--resolution", "128", "--up", "z"});
  EXPECT_TRUE(passes("cutsOpen", page()));
  std::ofstream cloud(folder / "cloud.xyz");
  for (const Vec3& p : open.positions) cloud << fmt::format("{} {} {}\n", p[0], p[1], p[2]);
  cloud.close();
  const Outcome points = run_sdm({"points", folder / "cloud.xyz", o2, "-o", out, "--up", "z"});
  ASSERT_EQ(points.code, 0) << points.err;
  EXPECT_TRUE(passes("cutsOpen", page()));
}

TEST_F(Page, NothingIsJudgedBeforeThereIsATolerance) {
  map({"--resolution", "64"});
  EXPECT_TRUE(passes("unjudged", page()));
  EXPECT_TRUE(passes("rounds", page()));
  const Outcome walls = run_sdm({"thickness", o1, "-o", out, "--resolution", "64"});
  ASSERT_EQ(walls.code, 0) << walls.err;
  EXPECT_TRUE(passes("wallLimits", page(), {"", ""}));
}

// The plane goes through the middle of the torus.
TEST_F(Page, DistancesWithoutSignsAreNeverNegative) {
  o2 = write_obj(folder / "middle.obj", square(8, 0.001));
  map({"--resolution", "64", "--sign", "none"});
  EXPECT_TRUE(passes("leastOfAll", page()));
}

TEST_F(Page, SaysSoWhereNoPictureCanBeDrawn) {
  map({"--resolution", "64", "--tolerance", "2.3"});
  EXPECT_TRUE(passes("withoutWebgl", page()));
}

TEST_F(Page, CanBeReadInNarrowWindows) {
  const std::string text = contents(o1), table = folder / "table.csv";
  std::ofstream(o1) << "g ring\n" << text;
  std::ofstream(table) << "group,lower,upper\nring,0,1\n";
  map({"--resolution", "64", "--tolerance", "2.3", "--tolerance-table", table, "--units", "mm"});
  EXPECT_TRUE(passes("narrow", page()));
}

TEST_F(Page, SectionsHideCallouts) {
  o1 = write_obj(folder / "a.obj", sphere(4));
  o2 = write_obj(folder / "b.obj", moved(sphere(4), {0.1, 0, 0}));
  map({"--resolution", "128", "--up", "z"});
  EXPECT_TRUE(passes("cutsCallouts", page()));
}

}  // namespace
}  // namespace sdm::test
