// `sdm map --engine gl` and `sdm sequence --engine gl` as a user runs them.
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/samples.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using Json = nlohmann::json;

struct GlCommand : ::testing::Test, TwoTori {
  [[nodiscard]] Json report(std::vector<std::string> more) const {
    more.push_back("--json");
    const Outcome run = run_sdm(map(std::move(more)));
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(names_in(out), kResults);
    return Json::parse(run.out, nullptr, false);
  }
};

std::uint64_t count(const Json& report, const char* key) {
  EXPECT_TRUE(report["raster"].contains(key)) << key;
  return report["raster"].value(key, std::uint64_t{0});
}

void expect_same_statistics(const Json& actual, const Json& expected) {
  for (const char* key : {"min", "max", "mean", "rms", "p50", "p95", "p99"})
    EXPECT_NEAR(actual["distance"][key], expected["distance"][key], 5e-6) << key;
  for (const char* key : {"texels_with_value", "negative_texels", "beyond_max_distance", "sign", "atlas"})
    EXPECT_EQ(actual[key], expected[key]) << key;
}

void expect_laws(const Json& r) {
  EXPECT_EQ(count(r, "pairs"), count(r, "culled_by_bound") + count(r, "culled_by_obb") +
                                   count(r, "clipped_away") + count(r, "polygons"));
  EXPECT_EQ(count(r, "pairs"), (count(r, "sites") - count(r, "sites_dropped")) * count(r, "tiles"));
  EXPECT_EQ(count(r, "sites"), 512u + 768u + 256u);
  EXPECT_EQ(count(r, "texels"), r["atlas"]["texels"]);
  EXPECT_GE(count(r, "fragments"), count(r, "texels"));
  EXPECT_EQ(count(r, "unconfirmed"), 0u);
  EXPECT_EQ(count(r, "stencil_lookups"), count(r, "stencil_hits") + count(r, "stencil_misses"));
}

TEST_F(GlCommand, ReportsTheStatisticsOfTheCpuEngineAndItsCounters) {
  const Json cpu = report({});
  const Json gl = report({"--engine", "gl"});
  EXPECT_FALSE(cpu.contains("raster"));
  EXPECT_EQ(gl["engine"], "gl");
  expect_same_statistics(gl, cpu);
  expect_laws(gl);
  EXPECT_EQ(gl["raster"]["clip"], "planes");
  EXPECT_EQ(count(gl, "stencil_lookups"), 0u);
  EXPECT_EQ(gl, Json::parse(contents(out + "/report.json")));
}

TEST_F(GlCommand, OptionsReachTheEngine) {
  const Json planes = report({"--engine", "gl"});
  const Json stencil = report({"--engine", "gl", "--clip", "stencil", "--stencil-values", "3",
                               "--no-bound-culling", "--device", "0"});
  expect_same_statistics(stencil, planes);
  expect_laws(stencil);
  EXPECT_EQ(stencil["raster"]["clip"], "stencil");
  EXPECT_EQ(count(stencil, "culled_by_bound"), 0u);
  EXPECT_GT(count(planes, "culled_by_bound"), 0u);
  EXPECT_EQ(count(stencil, "stencil_misses") - count(stencil, "stencil_evictions"), 3u);
}

TEST_F(GlCommand, InvalidOptionsAreUsageErrorsAndUnknownDevicesFail) {
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--stencil-values", "0"})).code, 2);
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--stencil-values", "256"})).code, 2);
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--clip", "scissors"})).code, 2);
  const Outcome unknown = run_sdm(map({"--engine", "gl", "--device", "no such device"}));
  EXPECT_EQ(unknown.code, 1);
  EXPECT_NE(unknown.err.find("no such device"), std::string::npos) << unknown.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

std::vector<float> distances_in(const std::string& file) {
  Imf::InputFile exr(file.c_str());
  const auto window = exr.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x) + 1,
             height = static_cast<std::size_t>(window.max.y) + 1;
  std::vector<float> values(width * height);
  Imf::FrameBuffer frame;
  frame.insert("distance.D", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                        width * sizeof(float)));
  exr.setFrameBuffer(frame);
  exr.readPixels(window.min.y, window.max.y);
  return values;
}

// The letters collide around frame 18.
TEST(GlSequence, HasTheFramesAndMapsOfTheCpuEngine) {
  const TemporaryFolder folder;
  const std::string scene = folder / "letters";
  ASSERT_EQ(run_sdm({"scene", "letters", "-o", scene, "--frames", "22", "--format", "ply"}).code, 0);
  const auto sequence = [&](const std::string& engine) {
    const Outcome run = run_sdm({"sequence", scene + "/E", scene + "/G", "-o", folder / engine,
                                 "--resolution", "64", "--maps", "21", "--engine", engine});
    EXPECT_EQ(run.code, 0) << run.err;
    std::istringstream text(contents(folder / (engine + "/frames.jsonl")));
    std::vector<Json> lines;
    for (std::string line; std::getline(text, line);) {
      lines.push_back(Json::parse(line));
      lines.back().erase("time_ms");
    }
    return lines;
  };
  EXPECT_EQ(sequence("gl"), sequence("cpu"));
  for (const char* map : {"0000.exr", "0021.exr"}) {
    const std::vector<float> gl = distances_in(folder / (std::string("gl/maps/") + map)),
                             cpu = distances_in(folder / (std::string("cpu/maps/") + map));
    ASSERT_EQ(gl.size(), cpu.size());
    std::size_t values = 0;
    for (std::size_t t = 0; t < gl.size(); ++t) {
      ASSERT_EQ(std::isnan(gl[t]), std::isnan(cpu[t])) << t;
      if (std::isnan(gl[t])) continue;
      ++values;
      ASSERT_NEAR(gl[t], cpu[t], 8e-6) << t;  // 2e-6 of the diagonal of both letters, below 3, and rounding
    }
    EXPECT_GT(values, 1000u);
  }
}

TEST(GlSequence, RefusesAnotherEngineForResumingAndEdits) {
  const TemporaryFolder folder;
  const std::string scene = folder / "letters", out = folder / "out";
  ASSERT_EQ(run_sdm({"scene", "letters", "-o", scene, "--frames", "4", "--format", "ply"}).code, 0);
  std::filesystem::remove(scene + "/E/00002.ply");
  const std::vector<std::string> arguments{"sequence", scene + "/E",   scene + "/G", "-o",
                                           out,        "--resolution", "64"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return run_sdm(more);
  };
  EXPECT_EQ(with({"--engine", "gl", "--allow-topology"}).code, 2);
  EXPECT_EQ(with({}).code, 1);  // the missing frame
  const Outcome other = with({"--resume", "--engine", "gl"});
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.err.find("--engine"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace sdm::test
