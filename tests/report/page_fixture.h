// A page of a map, and what a browser says of it.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "report/shared_runs.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {

using Json = nlohmann::json;

/// A torus above a square: the distance is the height, |z + 2|.
struct Page : ::testing::Test {
  static constexpr double kHeight = -2;
  TemporaryFolder folder;
  std::string o1 = write_obj(folder / "part.obj", ring(24)),
              o2 = write_obj(folder / "plane.obj", square(8, kHeight));
  std::string out = folder / "out";

  /// Maps, and returns the report.
  Json map(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"map", o1, o2, "--write", "exr,html"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = run_shared(arguments, out);
    EXPECT_TRUE(run.code == 0 || run.code == 3 || run.code == 4) << run.err;
    return Json::parse(contents(out + "/report.json"));
  }
  [[nodiscard]] std::string page() const { return out + "/report.html"; }
};

}  // namespace sdm::test
