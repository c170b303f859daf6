// How the pages look and move: sizes, schemes, print, contrast, and pictures while something moves.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "report/page_browser.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

/// A torus above a square, at whose height all distances are.
struct Looks : ::testing::Test {
  TemporaryFolder folder;
  std::string o1 = write_obj(folder / "part.obj", ring(24)),
              o2 = write_obj(folder / "plane.obj", square(8, -2)), out = folder / "out";

  void run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", out});
    const Outcome outcome = run_sdm(arguments);
    ASSERT_TRUE(outcome.code == 0 || outcome.code == 3 || outcome.code == 4) << outcome.err;
  }
  [[nodiscard]] std::string page() const { return out + "/report.html"; }
};

TEST_F(Looks, MovesInCoarsePicturesWhereFineOnesTakeLong) {
  o1 = write_obj(folder / "fine.obj", ring(96));
  run({"map", o1, o2, "--write", "html", "--resolution", "256", "--tolerance", "3"});
  EXPECT_TRUE(looks("drags", page(), {"6000"}));
}

TEST_F(Looks, ShowsAMapAtAllSizesAndOnPaper) {
  run({"map", o1, o2, "--write", "html", "--resolution", "128", "--tolerance", "2.3", "--units", "mm", "--up",
       "z", "--align", "--align-free", "x,y"});
  EXPECT_TRUE(looks("looks", page()));
  EXPECT_TRUE(looks("touches", page()));
  const auto report = nlohmann::json::parse(contents(out + "/report.json"));
  const std::string xxh3 = report["o1"]["xxh3"];
  EXPECT_EQ(xxh3.size(), 16);
  EXPECT_TRUE(looks("prints", page(),
                    {folder / "map.pdf", "2", "Measured on", "part.obj (XXH3 " + xxh3 + "), plane.obj (XXH3",
                     "Alignment", "Hausdorff", "Bands of distance", "-Display", "-report.json"}));
}

TEST_F(Looks, ShowsPointsThicknessAndSelfDistancesAtAllSizes) {
  std::ofstream cloud(folder / "cloud.xyz");
  for (int i = 0; i < 3000; ++i) {
    const double u = 0.1 * i, v = 0.37 * i, r = 1 + 0.4 * std::cos(v);
    cloud << fmt::format("{:.7} {:.7} {:.7}\n", r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
  }
  cloud.close();
  run({"points", folder / "cloud.xyz", o2, "--tolerance", "2.3", "--units", "mm"});
  EXPECT_TRUE(looks("looks", page()));
  run({"thickness", o1, "--write", "html", "--resolution", "64", "--min", "0.1", "--units", "mm"});
  EXPECT_TRUE(looks("looks", page()));
  run({"self", o1, "--write", "html", "--resolution", "64", "--geodesic", "0.5"});
  EXPECT_TRUE(looks("looks", page()));
}

// The square sinks towards the torus and through its middle.
TEST_F(Looks, ShowsAPlayerAtAllSizesAndOnPaper) {
  const std::filesystem::path moving = folder / "moving";
  std::filesystem::create_directory(moving);
  for (int i = 0; i < 6; ++i) write_obj(moving / fmt::format("{}.obj", i), square(8, 1 - 0.2 * i));
  run({"sequence", o1, moving, "--resolution", "64", "--player", "--both", "--up", "z", "--units", "mm"});
  const std::string player = out + "/player.html";
  EXPECT_TRUE(looks("looks", player));
  EXPECT_TRUE(looks("touches", player));
  EXPECT_TRUE(looks("opens", player, {"5", "part.obj", "moving"}));
  EXPECT_TRUE(looks(
      "prints", player,
      {folder / "player.pdf", "1", "Measured on", "part.obj (XXH3 " + file_xxh3(o1) + "), moving (XXH3 ",
       "Over time", "frame 5 (0 to 5)", "-Play", "-Display"}));
}

// Programs of pages are not larger than they were without what they show today.
TEST(Pages, AreSmall) {
  EXPECT_LT(std::filesystem::file_size(SDM_REPORT_HTML "/page.html"), 686'000);
  EXPECT_LT(std::filesystem::file_size(SDM_REPORT_HTML "/player.html"), 597'000);
  EXPECT_LT(std::filesystem::file_size(SDM_REPORT_HTML "/baked.html"), 590'000);
}

}  // namespace
}  // namespace sdm::test
