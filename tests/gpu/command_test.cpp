// `sdm map --engine gpu`: the device is chosen as asked, and the report says what the search counted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gpu.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

struct GpuCommand : ::testing::Test, TwoTori {};

TEST_F(GpuCommand, ReportsTheDeviceAndTheCounts) {
  const std::string name = gpu_devices()[0].name;
  for (const std::string& device : {std::string("0"), name}) {
    const Outcome run = run_sdm(map({"--engine", "gpu", "--device", device, "--json"}));
    ASSERT_EQ(run.code, 0) << run.err;
    const Json report = Json::parse(run.out);
    EXPECT_EQ(report["engine"], "gpu");
    EXPECT_EQ(report["gpu"]["device"], name);
    EXPECT_EQ(report["gpu"]["results"], "read back (double)");
    EXPECT_GE(report["gpu"]["points"], report["texels_with_value"]);
    EXPECT_GT(report["gpu"]["tests"], 0);
    EXPECT_EQ(report["gpu"]["incomplete"], 0);
  }
}

TEST_F(GpuCommand, UnknownDevicesFail) {
  // A number is one of the list, although names have digits, too.
  for (const std::string& device : {std::string("no such device"), std::to_string(gpu_devices().size())}) {
    const Outcome run = run_sdm(map({"--engine", "gpu", "--device", device}));
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.err, StartsWith("sdm: error: the gpu engine found no device '" + device + "'"));
    EXPECT_THAT(run.err, HasSubstr(gpu_devices()[0].name));
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

// What does not ask an engine says so.
TEST_F(GpuCommand, MeasuresWithoutAnEngineRefuseIt) {
  const Outcome run = run_sdm(map({"--engine", "gpu", "--along", "0,0,1"}));
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("--along excludes --engine gpu"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace sdm::test
