// `--ignore-islands` of `sdm map`: floating specks of a scan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_edit.h>

#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "support/error_of.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr std::uint32_t kSpecks = 60;
constexpr double kDepth = 0.05, kSpeckSide = 0.01;
const Vec3 kDent{0, 0, 1};

/// A ball with a dent at kDent, around which specks of one face float.
Mesh specked_ball() {
  Mesh mesh = sphere(4);
  for (Vec3& p : mesh.positions)
    if (const double d = norm(p - kDent) / 0.3; d < 1) p = (1 - kDepth * (1 - d * d)) * p;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1), far(1.3, 1.6);
  for (std::uint32_t i = 0; i < kSpecks; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3 p = far(random) * normalized({any(random), any(random), any(random)});
    for (const Vec3& offset : {Vec3{}, Vec3{kSpeckSide, 0, 0}, Vec3{0, kSpeckSide, 0}})
      mesh.positions.push_back(p + offset);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(RemoveIslands, LeavesComponentsBelowALimitOut) {
  const Mesh mesh = specked_ball(), ball = sphere(4);
  const double speck = kSpeckSide * kSpeckSide / 2;
  for (const IslandLimits& limits :
       {IslandLimits{.faces = 2}, IslandLimits{.area = 1.01 * speck}, IslandLimits{.area_fraction = 0.01}}) {
    const WithoutIslands rest = remove_islands(mesh, limits);
    EXPECT_EQ(rest.islands, kSpecks);
    EXPECT_EQ(rest.faces, kSpecks);
    EXPECT_NEAR(rest.area, kSpecks * speck, 1e-12);
    EXPECT_NEAR(rest.area_fraction, rest.area / inspect(mesh).area, 1e-12);
    EXPECT_EQ(rest.mesh.triangles, ball.triangles);
    EXPECT_EQ(rest.mesh.positions, mesh.positions);
    ASSERT_EQ(rest.face.size(), ball.triangles.size());
    for (std::uint32_t f = 0; f < rest.face.size(); ++f) EXPECT_EQ(rest.face[f], f);
  }
  for (const IslandLimits& limits :
       {IslandLimits{}, IslandLimits{.faces = 1}, IslandLimits{.area = 0.99 * speck}}) {
    const WithoutIslands all = remove_islands(mesh, limits);
    EXPECT_EQ(all.islands, 0u);
    EXPECT_EQ(all.mesh.triangles, mesh.triangles);
  }
  EXPECT_THAT(error_of([&] { return remove_islands(mesh, {.faces = 100000}); }),
              HasSubstr("every component"));
  EXPECT_THAT(error_of([&] { return remove_islands(mesh, {.area = -1}); }), HasSubstr("negative"));
  EXPECT_THAT(error_of([&] { return remove_islands(mesh, {.area_fraction = 2}); }), HasSubstr("fraction"));
}

struct IgnoreIslands : ::testing::Test {
  TemporaryFolder folder;
  std::string o1 = write_obj(folder / "scan.obj", specked_ball());
  std::string o2 = write_obj(folder / "part.obj", sphere(4));

  Outcome map(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"map",          o1,    o2,        "-o", folder / "out",
                                       "--resolution", "256", "--write", "csv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

TEST_F(IgnoreIslands, TheVerdictIsThatOfThePart) {
  EXPECT_EQ(map({"--tolerance", "0.1"}).code, 3) << "by the specks";
  EXPECT_EQ(map({"--tolerance", "0.1", "--ignore-islands", "20"}).code, 0);
  EXPECT_EQ(map({"--tolerance", "0.1", "--ignore-islands", "1%"}).code, 0);
  EXPECT_EQ(map({"--tolerance", "0.1", "--ignore-islands", "area:0.0001", "--align", "--accept-doubts"}).code,
            0);
  EXPECT_EQ(map({"--tolerance", "0.1", "--ignore-islands", "area:0.00001"}).code, 3);
  const Outcome dent = map({"--tolerance", "0.03", "--ignore-islands", "20", "--json"});
  EXPECT_EQ(dent.code, 3);
  const Json report = Json::parse(dent.out);
  EXPECT_NEAR(report["extremes"]["min"]["distance"], -kDepth, 1e-3);
  EXPECT_NEAR(report["extremes"]["min"]["point"][2], 1 - kDepth, 1e-2);
  EXPECT_LT(report["extremes"]["max"]["distance"], 0.01);
}

TEST_F(IgnoreIslands, IsReported) {
  const Outcome run = map({"--ignore-islands", "20", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["o1"]["ignored_islands"]["islands"], kSpecks);
  EXPECT_EQ(report["o1"]["ignored_islands"]["triangles"], kSpecks);
  EXPECT_EQ(report["o1"]["triangles"], sphere(4).triangles.size());
  EXPECT_EQ(report["o1"]["vertices"], sphere(4).positions.size());
  // The rows of vertices.csv are those of the file; what is left out has no value.
  std::istringstream csv(contents(folder / "out/vertices.csv"));
  std::string row;
  std::vector<std::string> rows;
  while (std::getline(csv, row)) rows.push_back(row);
  const std::size_t vertices = sphere(4).positions.size();
  ASSERT_EQ(rows.size(), 1 + vertices + 3 * kSpecks);
  for (std::size_t v = 0; v < rows.size() - 1; ++v)
    EXPECT_EQ(rows[1 + v].ends_with(','), v >= vertices) << rows[1 + v];
  EXPECT_THAT(report["notes"].dump(), HasSubstr("60 islands with 60 faces"));
  EXPECT_THAT(map({"--ignore-islands", "20"}).out, HasSubstr("60 islands with 60 faces"));
  EXPECT_FALSE(Json::parse(map({"--json"}).out)["o1"].contains("ignored_islands"));
}

TEST_F(IgnoreIslands, FaultsAreNamed) {
  for (const char* bad : {"0", "-3", "2.5", "0%", "101%", "area:0", "area:x", "area:1%", "", "%"})
    EXPECT_EQ(map({std::string("--ignore-islands=") + bad}).code, 2) << bad;
  const Outcome all = map({"--ignore-islands", "1000000"});
  EXPECT_EQ(all.code, 1);
  EXPECT_THAT(all.err, HasSubstr("scan.obj: every component of the mesh is below the limit"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace sdm::test
