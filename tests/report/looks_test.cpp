// How the pages look and move: sizes, schemes, print, contrast, and pictures while something moves.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

/// Runs a check of check_looks.cjs, in a browser.
bool looks(const std::string& check, const std::string& page, const std::vector<std::string>& more = {}) {
  std::string command("cd '" SDM_REPORT_PACKAGES "' && node '" SDM_CHECK_LOOKS "' " + check + " '" + page +
                      "'");
  for (const std::string& argument : more) command.append(" '").append(argument).append("'");
  return std::system(command.c_str()) == 0;
}

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
  EXPECT_TRUE(looks("drags", page(), {"9000"}));
}

}  // namespace
}  // namespace sdm::test
