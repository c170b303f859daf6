// `sdm devices`, the options of the gl engine, and machines without a device.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/error_of.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

TEST(DevicesCommand, ListsTheDevicesOfBothEngines) {
  const Outcome table = run_sdm({"devices"});
  const Outcome json = run_sdm({"devices", "--json"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_EQ(json.code, 0) << json.err;
  Json expected = Json::array();
  const auto expect = [&](const std::string& engine, const auto& devices) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      const auto& device = devices[i];
      EXPECT_THAT(table.out,
                  AllOf(HasSubstr(std::to_string(i) + "  " + device.name), HasSubstr(device.driver),
                        HasSubstr(device.software ? "software" : "hardware")));
      expected.push_back({{"engine", engine},
                          {"index", i},
                          {"name", device.name},
                          {"driver", device.driver},
                          {"software", device.software}});
    }
  };
  expect("gl", gl_devices());
  if (error_of(gpu_devices).empty())
    expect("gpu", gpu_devices());
  else
    EXPECT_THAT(table.err, HasSubstr(error_of(gpu_devices)));
  EXPECT_EQ(std::ranges::count(table.out, '\n'), expected.size());
  EXPECT_EQ(Json::parse(json.out), expected);
}

struct GlCommandOptions : ::testing::Test, TwoTori {};

TEST_F(GlCommandOptions, RequireTheGlEngine) {
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--clip", "planes"},
                                                 {"--clip", "stencil"},
                                                 {"--stencil-values", "255"},
                                                 {"--no-bound-culling"}})
    for (const std::vector<std::string>& engine :
         {std::vector<std::string>{}, {"--engine", "cpu"}, {"--engine", "reference"}}) {
      auto more = option;
      more.insert(more.end(), engine.begin(), engine.end());
      const Outcome run = run_sdm(map(more));
      EXPECT_EQ(run.code, 2);
      EXPECT_THAT(run.err, StartsWith("sdm: error: " + option[0] + ": needs --engine gl\n"));
      EXPECT_EQ(run.out, "");
    }
  EXPECT_THAT(run_sdm(map({"--device", "0"})).err,
              StartsWith("sdm: error: --device: needs --engine gl or gpu\n"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(GlCommandOptions, StencilValuesRequireStencilAndRangeFrom1To255) {
  EXPECT_THAT(run_sdm(map({"--engine", "gl", "--stencil-values", "3"})).err,
              StartsWith("sdm: error: --stencil-values: needs --clip stencil\n"));
  for (const char* values : {"0", "256", "-1", "many", "1.5"}) {
    const Outcome run = run_sdm(map({"--engine", "gl", "--clip", "stencil", "--stencil-values", values}));
    EXPECT_EQ(run.code, 2) << values;
    EXPECT_THAT(run.err, HasSubstr("from 1 to 255"));
  }
}

struct WithoutDevice : ::testing::Test, TwoTori {
  /// The command fails with one sentence that contains both strings, and leaves no files.
  void expect_failure(const Outcome& run, const std::string& fault, const std::string& advice) const {
    EXPECT_EQ(run.code, 1);
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, AllOf(StartsWith("sdm: error: "), HasSubstr(fault), HasSubstr(advice)));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
};

TEST_F(WithoutDevice, MissingDriverIsOneSentence) {
  for (const char* name : {"__EGL_VENDOR_LIBRARY_DIRS", "__EGL_VENDOR_LIBRARY_FILENAMES"}) {
    const Conditions conditions{.environment = {std::string(name) + "=/nowhere", "VK_DRIVER_FILES=/nowhere",
                                                "VK_ICD_FILENAMES=/nowhere"}};
    expect_failure(run_sdm({"devices"}, conditions), "no device", "libgl1-mesa-dri");
    expect_failure(run_sdm(map({"--engine", "gl"}), conditions), "no device", "libgl1-mesa-dri");
    EXPECT_EQ(run_sdm(map({"--quiet"}), conditions).code, 0) << "the cpu engine needs none";
    std::filesystem::remove_all(out);
  }
}

TEST_F(WithoutDevice, OldOpenGLIsOneSentence) {
  const Conditions mesa_44{
      .environment = {"VK_DRIVER_FILES=/nowhere", "VK_ICD_FILENAMES=/nowhere",
                      "__EGL_VENDOR_LIBRARY_FILENAMES=/usr/share/glvnd/egl_vendor.d/50_mesa.json",
                      "MESA_GL_VERSION_OVERRIDE=4.4"}};
  expect_failure(run_sdm({"devices"}, mesa_44), "no OpenGL 4.5", "driver");
  expect_failure(run_sdm(map({"--engine", "gl"}), mesa_44), "no OpenGL 4.5", "driver");
}

TEST_F(WithoutDevice, UnknownDeviceErrorListsTheDevices) {
  expect_failure(run_sdm(map({"--engine", "gl", "--device", "no such device"})), "no such device",
                 gl_devices()[0].name);
}

}  // namespace
}  // namespace sdm::test
