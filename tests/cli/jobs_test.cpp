// Whole jobs with a known answer: good parts and parts with a defect, dents in sheets, files of other
// programs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cli/samples.h"
#include "geometry/vec.h"
#include "map/terrain.h"
#include "support/hausdorff_oracle.h"
#include "support/judged_parts.h"
#include "support/meshes.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using Json = nlohmann::json;

struct Jobs : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out";

  [[nodiscard]] Outcome map(const std::string& o1, const std::string& o2,
                            const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"map", o1, o2, "-o", out, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

// The limit is 1 % of the size. Good parts have other vertices and are moved by 0.6 of it.
TEST_F(Jobs, TwentyGoodPartsPassAndTwentyDefectsFail) {
  constexpr double kLimit = 0.01;
  int bounded = 0;
  const auto parts = judged_parts();
  ASSERT_EQ(parts.size(), 20U);
  for (const auto& [name, part] : parts) {
    SCOPED_TRACE(name);
    const Mesh good = moved(remeshed(part), {0.6 * kLimit, 0, 0});
    const std::string o2 = write_obj(folder / "part.obj", part);
    const auto judged = [&](const Mesh& o1) {
      const std::vector<std::string> options{"--resolution", "256",         "--write",
                                             "none",         "--tolerance", fmt::format("{}", kLimit)};
      const Outcome run = map(write_obj(folder / "scan.obj", o1), o2, options);
      const Json tolerance = Json::parse(run.out)["tolerance"];
      EXPECT_EQ(tolerance["certified"], true) << tolerance;
      return run.code;
    };
    EXPECT_EQ(judged(good), 0);
    EXPECT_EQ(judged(with_defect(part, kLimit)), 3);
    // What PASS claims, by brute force. The truth of the defects is CGAL's.
    if (part.triangles.size() > 200) continue;
    EXPECT_LE(oracle::hausdorff_bounds(good, part, 0.3 * kLimit)[1], kLimit);
    ++bounded;
  }
  EXPECT_GE(bounded, 3);
}

struct Dents : Jobs {
  [[nodiscard]] Outcome judge(double thickness, double depth, std::vector<std::string> more) const {
    more.insert(more.end(), {"--tolerance", "0.6", "--write", "csv", "--resolution", "128"});
    return map(write_obj(folder / "scan.obj", dented(40, depth)),
               write_obj(folder / "sheet.obj", thick_plate(thickness)), more);
  }
};

struct ThinWalls : Dents, ::testing::WithParamInterface<double> {};

// The distance at each vertex of the scan is its height over the upper side: none is of another skin.
TEST_P(ThinWalls, ShowDentsOfTheirOwnSkin) {
  const Outcome run = judge(GetParam(), 0.79, {"--facing"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json report = Json::parse(run.out), least = report["extremes"]["min"];
  EXPECT_NEAR(least["distance"], -0.79, 1e-5);
  EXPECT_LT(norm(Vec3{least["point"].get<std::array<double, 3>>()} - Vec3{10, 10, -0.79}), 1e-5);
  EXPECT_EQ(report["without_match"], 0);
  std::ifstream csv(out + "/vertices.csv");
  std::string line;
  std::getline(csv, line);
  ASSERT_EQ(line, "vertex,x,y,z,distance");
  int rows = 0, wrong = 0;
  for (std::array<double, 5> row{}; std::getline(csv, line); ++rows) {
    std::istringstream numbers(line);
    for (double& x : row) numbers >> x, numbers.ignore(1);
    wrong += !(std::abs(row[4] - row[3]) < 1e-5);
  }
  EXPECT_EQ(rows, 41 * 41);
  EXPECT_EQ(wrong, 0);

  const Outcome good = judge(GetParam(), 0.5, {"--facing"});
  EXPECT_EQ(good.code, 0) << good.out << good.err;
  EXPECT_EQ(Json::parse(good.out)["tolerance"]["certified"], true) << "between the texels too";
}

// Below the middle of the wall, the closest point is of the other skin: distances do not show the dent, but
// the verdict is by the faces that face the same way.
TEST_F(Dents, AreJudgedWithoutFacing) {
  const Outcome run = judge(1, 0.79, {});
  EXPECT_EQ(run.code, 3) << run.out << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_GE(report["extremes"]["min"]["distance"], -0.5);
  EXPECT_EQ(report["tolerance"]["by_facing"], true);
  EXPECT_LT(report["tolerance"]["proof"]["witness"]["distance"], -0.6);
  EXPECT_EQ(judge(1, 0.5, {}).code, 0);
}

INSTANTIATE_TEST_SUITE_P(Thickness, ThinWalls, ::testing::Values(0.5, 1.0, 2.0, 3.0));

/// A welder of its own: corners that are at most `reach` apart are one vertex. Whether each edge then has two
/// faces; faces that repeat a vertex are none.
bool closes(const Mesh& mesh, double reach) {
  std::map<std::array<std::int64_t, 3>, std::vector<std::uint32_t>> cells;
  std::vector<std::uint32_t> set(mesh.positions.size());
  std::iota(set.begin(), set.end(), 0U);
  const auto of = [&set](std::uint32_t v) {
    while (set[v] != v) v = set[v] = set[set[v]];
    return v;
  };
  const double cell = reach > 0 ? reach : diagonal(bounds(mesh));
  const auto key = [cell](const Vec3& p, int k) {
    return static_cast<std::int64_t>(std::floor(p[k] / cell));
  };
  for (std::uint32_t v = 0; v < set.size() && reach > 0; ++v) {
    const Vec3& p = mesh.positions[v];
    for (int i = 0; i < 27; ++i) {
      const auto near = cells.find({key(p, 0) + i % 3 - 1, key(p, 1) + i / 3 % 3 - 1, key(p, 2) + i / 9 - 1});
      if (near == cells.end()) continue;
      for (const std::uint32_t other : near->second)
        if (norm(mesh.positions[other] - p) <= reach) set[of(v)] = of(other);
    }
    cells[{key(p, 0), key(p, 1), key(p, 2)}].push_back(v);
  }
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    const Triangle corners{of(t[0]), of(t[1]), of(t[2])};
    if (std::set(corners.begin(), corners.end()).size() < 3) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax({corners[k], corners[(k + 1) % 3]});
      ++edges[{a, b}];
    }
  }
  return !edges.empty() && std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 2; });
}

std::vector<std::filesystem::path> installed_stl_files() {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& where :
       {std::filesystem::path(mesh_file("")), std::filesystem::path("/usr/share/opencascade/data/stl")}) {
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(where, none))
      if (entry.path().extension() == ".stl") files.push_back(entry.path());
  }
  return files;
}

TEST_F(Jobs, StlFilesThatCloseAreClosed) {
  const std::string o1 = write_obj(folder / "triangle.obj", single_triangle());
  int closed = 0;
  for (const std::filesystem::path& file : installed_stl_files()) {
    SCOPED_TRACE(file);
    const Mesh mesh = read_mesh(file);
    const double size = diagonal(bounds(mesh));
    if (std::ranges::none_of(std::array{0.0, 1e-9, 1e-7, 1e-6},
                             [&](double reach) { return closes(mesh, reach * size); }))
      continue;
    ++closed;
    const Outcome run = map(o1, file, {"--weld", "auto", "--resolution", "16", "--write", "none"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(Json::parse(run.out)["o2"]["closed"], true);
  }
  EXPECT_GE(closed, std::filesystem::exists("/usr/share/opencascade/data/stl/shape.stl") ? 6 : 1);
}

// As CAD programs write them: each face with corners of its own, off by rounding.
TEST_F(Jobs, ClosedMeshesOffByRoundingAreClosedAgain) {
  int closed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(mesh_file(""))) {
    if (entry.path().extension() != ".off" || entry.file_size() > 1'000'000) continue;
    SCOPED_TRACE(entry.path());
    const Mesh mesh = read_mesh(entry.path());
    if (!inspect(mesh).closed) continue;
    const double error = 1e-7 * diagonal(bounds(mesh));
    const Mesh apart = taken_apart(mesh, error);
    if (!closes(apart, 4 * error)) continue;  // by faces that are smaller than that
    ++closed;
    const Welded welded = weld(apart);
    EXPECT_TRUE(inspect(welded.mesh).closed) << welded.boundary_edges << " edges are open";
    EXPECT_LE(welded.largest_move, 4 * error);
  }
  EXPECT_GE(closed, 50);
}

}  // namespace
}  // namespace sdm::test
