// `sdm volume`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/volume.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

struct VolumeCommand : ::testing::Test, TwoTori {};

TEST_F(VolumeCommand, WritesTheFieldOfTheLibrary) {
  const Sites sites(read_mesh(o2));
  Box box = bounds(sites.mesh());
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= 0.2;
    box.upper[k] += 0.2;
  }
  const DistanceField expected =
      compute_field(sites, make_grid(box, {20, 21, 9}), {.max_distance = 0.2, .sites = true});
  for (const std::string extension : {".npy", ".vti", ".vdb"}) {
    SCOPED_TRACE(extension);
    const std::filesystem::path file = folder / "new" / ("field" + extension),
                                same = folder / ("same" + extension);
    const Outcome run = run_sdm({"volume", o2, "--grid", "20", "21", "9", "--max-distance", "0.2", "--sites",
                                 "--json", "--units", "mm", "-o", file.string()});
    ASSERT_EQ(run.code, 0) << run.err;
    write_field(same, expected);
    EXPECT_EQ(contents(file), contents(same));
    const Json json = Json::parse(run.out);
    EXPECT_EQ(json["grid"]["points"], expected.grid.dims);
    EXPECT_EQ(json["grid"]["origin"], expected.grid.origin);
    EXPECT_EQ(json["grid"]["spacing"], expected.grid.spacing);
    EXPECT_EQ(json["max_distance"], 0.2);
    EXPECT_EQ(json["sign"]["method"], "exact");
    EXPECT_EQ(json["beyond_max_distance"], expected.beyond_max_distance);
    EXPECT_EQ(json["accuracy"], expected.accuracy);
    EXPECT_EQ(json["units"], "mm");
    EXPECT_EQ(json["file"], file.string());
    EXPECT_EQ(run.err, "") << "progress is for terminals";
  }
  EXPECT_EQ(names_in(folder / "new"), (std::vector<std::string>{"field.npy", "field.vdb", "field.vti"}));
}

TEST_F(VolumeCommand, WrongUsage) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"-o", "f.vdb"}, "--grid"},
      {{"--grid", "4", "4", "4", "--spacing", "1", "-o", "f.vdb"}, "--grid"},
      {{"--grid", "4", "4", "-o", "f.vdb"}, "--grid"},
      {{"--grid", "4", "0", "4", "-o", "f.vdb"}, "1 to 1048576"},
      {{"--grid", "4", "4", "9999999", "-o", "f.vdb"}, "1 to 1048576"},
      {{"--spacing", "-1", "-o", "f.vdb"}, "positive"},
      {{"--spacing", "1", "--max-distance", "0", "-o", "f.vdb"}, "--max-distance is 0"},
      {{"--spacing", "1", "--bounds", "0", "0", "0", "1", "1", "-o", "f.vdb"}, "--bounds"},
      {{"--spacing", "1", "--bounds", "0", "0", "0", "1", "1", "-1", "-o", "f.vdb"}, "lowest"},
      {{"--spacing", "1", "-o", "f.raw"}, ".vdb (OpenVDB)"},
      {{"--spacing", "1", "-o", "vdb"}, ".vdb (OpenVDB)"},
      {{"--spacing", "1"}, "-o"}};
  for (const auto& [options, fault] : cases) {
    std::vector<std::string> command{"volume", o2};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome run = run_sdm(command);
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(fault));
  }
}

TEST_F(VolumeCommand, FailsWithoutAFile) {
  const std::string open = write_obj(folder / "open.obj", single_triangle()), file = folder / "out" / "f.vdb";
  const auto run = [&](std::vector<std::string> options, const Conditions& conditions = {}) {
    options.insert(options.begin(), "volume");
    options.insert(options.end(), {"-o", file});
    return run_sdm(options, conditions);
  };
  EXPECT_THAT(run({open, "--spacing", "0.1", "--sign", "exact"}).err, HasSubstr("open"));
  EXPECT_THAT(run({o2, "--spacing", "1e-8"}).err, HasSubstr("larger spacing"));
  EXPECT_THAT(run({o2, "--spacing", "1e-5"}).err, HasSubstr("needs"));
  EXPECT_THAT(run({folder / "none.obj", "--spacing", "1"}).err, HasSubstr("none.obj"));
  const Outcome full = run({o2, "--spacing", "0.05"}, {.file_size = 10000});
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, HasSubstr(file)) << "names the file, not its temporary place";
  const Outcome stopped = run({o2, "--spacing", "0.004"}, {.interrupt_after_ms = 300});
  EXPECT_NE(stopped.code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace sdm::test
