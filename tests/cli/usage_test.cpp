#include "support/run_sdm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/io.h>
#include <sdm/version.h>

#include <vector>

#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

TEST(Usage, NoArgumentsShowTheHelp) {
  const Outcome run = run_sdm({});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("sdm map"));
  EXPECT_EQ(run.err, "");
}

TEST(Usage, HelpAndVersionAreNoErrors) {
  EXPECT_EQ(run_sdm({"--version"}).out, std::string("sdm ") + kVersion + "\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"map", "--help"}, {"info", "--help"}, {"--version"}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
  }
  EXPECT_THAT(run_sdm({"map", "--help"}).out, HasSubstr("Example"));
}

// Each is refused before any file is looked at, with a message that names the part at fault.
TEST(Usage, WrongUsageEndsWithTwo) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::vector<std::string> start{"map", "a.obj", "b.obj", "-o", out};
  const std::vector<std::vector<std::string>> wrong_tails{{"--resolution", "15"},
                                                          {"--resolution", "32769"},
                                                          {"--resolution", "many"},
                                                          {"--resolution", "1e3"},
                                                          {"--resolution", "-64"},
                                                          {"--resolution"},
                                                          {"--precision", "0"},
                                                          {"--precision", "fine"},
                                                          {"--precision", "0.1", "--resolution", "64"},
                                                          {"--atlas", "chart"},
                                                          {"--atlas", "0"},
                                                          {"--sign", "maybe"},
                                                          {"--engine", "gpu"},
                                                          {"--colormap", "jet"},
                                                          {"--max-stretch", "1"},
                                                          {"--max-stretch", "nan"},
                                                          {"--max-distance", "0"},
                                                          {"--max-distance", "-1"},
                                                          {"--max-distance", "inf"},
                                                          {"--tolerance", "-0.1"},
                                                          {"--tolerance", "x"},
                                                          {"--tolerance", "0.2:-0.1"},
                                                          {"--tolerance", "0.1:"},
                                                          {"--tolerance", "0:1:2"},
                                                          {"--bands", "1,1"},
                                                          {"--bands", "0,x"},
                                                          {"--range", "1"},
                                                          {"--range", "1", "1"},
                                                          {"--range", "2", "-2"},
                                                          {"--range", "0", "nan"},
                                                          {"--threads", "-1"},
                                                          {"--threads", "two"},
                                                          {"--transform-o1", "fot"},
                                                          {"--transform-o2", "scale"},
                                                          {"--transform-o1", "translate:1:2"},
                                                          {"--transform-o2", "fit,,fit"},
                                                          {"--unknown"},
                                                          {"c.obj"}};
  for (const auto& tail : wrong_tails) {
    auto arguments = start;
    arguments.insert(arguments.end(), tail.begin(), tail.end());
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2) << tail[0] << ' ' << tail.back() << '\n' << run.err;
    EXPECT_THAT(run.err, HasSubstr(tail[0]));
    EXPECT_EQ(run.out, "");
  }
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"map"},
        {"map", "a.obj", "-o", out},
        {"map", "a.obj", "b.obj"},
        {"mop"},
        {"info"},
        {"map", "a.obj", "b.obj", "-o"},
        {"map", "a.obj", "b.obj", "-o", out, "--tolerance", "2", "--max-distance", "1"},
        {"map", "a.obj", "b.obj", "-o", out, "--tolerance", "-2:0.5", "--max-distance", "1"}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err, "");
  }
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace sdm::test
