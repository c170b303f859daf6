// `sdm-paper field`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "research/fields/fields.h"
#include "research/run_sdm_paper.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

struct FieldCommand : ::testing::Test, TwoTori {};

TEST_F(FieldCommand, HasAllMethods) {
  for (const fields::MethodInfo& method : fields::methods()) {
    SCOPED_TRACE(method.name);
    const Outcome run =
        run_sdm_paper({"field", o2, "--spacing", "0.25", "--max-distance", "0.3", "--method",
                       std::string(method.name), "--sign", "none", "--json", "-o", folder / "f.npy"});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json json = Json::parse(run.out);
    EXPECT_EQ(json["method"], method.name);
    EXPECT_EQ(json["sign"]["method"], "none");
    EXPECT_EQ(json["grid"]["spacing"], (Vec3{0.25, 0.25, 0.25}));
    EXPECT_GE(json["distance"]["min"], 0);
    EXPECT_LE(json["distance"]["max"], 0.3 + 1e-6);
    const bool of_the_literature =
        method.method != fields::Method::best && method.method != fields::Method::reference;
    EXPECT_EQ(json["work"]["evaluations"] > 0, of_the_literature);
  }
}

TEST_F(FieldCommand, DrawsDistanceFunctionsAsMeshes) {
  const Outcome run = run_sdm_paper({"field", o2, "--spacing", "0.25", "--method", "brute_force",
                                     "--tessellation", "0.05", "--json", "-o", folder / "f.npy"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_NEAR(json["accuracy"], 0.05, 1e-4);
  EXPECT_EQ(json["sign"]["method"], "none");
}

TEST_F(FieldCommand, EstimatesProximity) {
  const std::vector<std::string> command{"field", o2, "--spacing", "0.1", "--proximity", o1};
  std::vector<std::string> apart = command, as_json = command;
  apart.insert(apart.end(), {"--transform-o1", "translate:0:0:3"});
  const Outcome text = run_sdm_paper(apart);
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("separation"));
  EXPECT_THAT(text.out, HasSubstr("(bounded)"));
  EXPECT_THAT(text.out, HasSubstr("colliding  no (exact)"));
  as_json.push_back("--json");
  const Outcome run = run_sdm_paper(as_json);
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out)["proximity"];
  EXPECT_LE(json["separation"]["lower"], json["separation"]["value"]);
  EXPECT_GE(json["separation"]["upper"], json["separation"]["value"]);
  EXPECT_EQ(json["depth"]["kind"], "bounded");
  EXPECT_GT(json["samples"], 144);
}

TEST_F(FieldCommand, WritesWhatTheCommandVolumeWrites) {
  const std::vector<std::string> options{o2, "--spacing", "0.25", "--max-distance", "0.3", "--sites", "-o"};
  const auto write = [&](const char* name, auto&& run, const char* command) {
    std::vector<std::string> arguments{command};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.push_back(folder / name);
    const Outcome outcome = run(arguments, Conditions{});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return contents(folder / name);
  };
  EXPECT_EQ(write("field.vti", run_sdm_paper, "field"), write("volume.vti", run_sdm, "volume"));
}

TEST_F(FieldCommand, WrongUsage) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"-o", "f.vdb"}, "--grid"},
      {{"--spacing", "1", "--tessellation", "0.1", "-o", "f.vdb"}, "--method brute_force"},
      {{"--spacing", "1", "--method", "brute_force", "--tessellation", "0", "-o", "f.vdb"}, "positive"},
      {{"--spacing", "1", "--method", "csc", "-o", "f.vdb"}, "csc needs --max-distance"},
      {{"--spacing", "1", "--method", "fast", "-o", "f.vdb"}, "not one of"},
      {{"--spacing", "1", "-o", "f.raw"}, ".vdb (OpenVDB)"},
      {{"--spacing", "1"}, "-o"},
      {{"--spacing", "1", "--sample-spacing", "1", "-o", "f.vdb"}, "--proximity"}};
  for (const auto& [options, fault] : cases) {
    std::vector<std::string> command{"field", o2};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome run = run_sdm_paper(command);
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(fault));
  }
}

}  // namespace
}  // namespace sdm::test
