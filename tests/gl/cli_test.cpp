// `sdm map --engine gl` as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
                               "--no-bound-culling", "--gl-device", "0"});
  expect_same_statistics(stencil, planes);
  expect_laws(stencil);
  EXPECT_EQ(stencil["raster"]["clip"], "stencil");
  EXPECT_EQ(count(stencil, "culled_by_bound"), 0u);
  EXPECT_GT(count(planes, "culled_by_bound"), 0u);
  EXPECT_EQ(count(stencil, "stencil_misses") - count(stencil, "stencil_evictions"), 3u);
}

TEST_F(GlCommand, PaperLiteralIsReportedAsAnEstimate) {
  const Json exact = report({"--engine", "gl"});
  EXPECT_EQ(exact["raster"]["paper_literal"], false);
  EXPECT_EQ(exact["accuracy_kind"], "bounded");
  EXPECT_GT(exact["accuracy"], 0);
  EXPECT_EQ(exact["error_bound_kind"], "bounded");
  const Json literal = report({"--engine", "gl", "--paper-literal", "--stencil-values", "7"});
  EXPECT_EQ(literal["raster"]["paper_literal"], true);
  EXPECT_EQ(literal["raster"]["clip"], "stencil");
  EXPECT_EQ(literal["accuracy_kind"], "unknown");
  EXPECT_TRUE(literal["accuracy"].is_null());
  EXPECT_EQ(literal["error_bound_kind"], "unknown");
  EXPECT_TRUE(literal["error_bound"].is_null());
  EXPECT_EQ(count(literal, "unconfirmed"), 0u);
  EXPECT_NE(literal["distance"]["mean"], exact["distance"]["mean"]);
  EXPECT_NE(run_sdm(map({"--engine", "gl", "--paper-literal"})).out.find("estimate"), std::string::npos);
}

TEST_F(GlCommand, InvalidOptionsAreUsageErrorsAndUnknownDevicesFail) {
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--stencil-values", "0"})).code, 2);
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--stencil-values", "256"})).code, 2);
  EXPECT_EQ(run_sdm(map({"--engine", "gl", "--clip", "scissors"})).code, 2);
  const Outcome unknown = run_sdm(map({"--engine", "gl", "--gl-device", "no such device"}));
  EXPECT_EQ(unknown.code, 1);
  EXPECT_NE(unknown.err.find("no such device"), std::string::npos) << unknown.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace sdm::test
