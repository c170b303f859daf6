#include "cli/samples.h"
#include "support/run_sdm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>
#include <sdm/sampling_bound.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/version.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

struct MapCommand : ::testing::Test, TwoTori {};

TEST_F(MapCommand, WritesAllResultsAndTellsWhere) {
  const Outcome run = run_sdm(map());
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), kResults);
  EXPECT_THAT(run.out, HasSubstr(out));
  EXPECT_THAT(run.out, HasSubstr("max"));
  EXPECT_EQ(run.err, "") << "progress is for terminals";
}

// Files of an earlier run, which would belong to another map, disappear.
TEST_F(MapCommand, WritesTheFilesAskedFor) {
  ASSERT_EQ(run_sdm(map()).code, 0);
  const std::string report = contents(out + "/report.json");
  const Outcome some = run_sdm(map({"--write", "glb,exr"}));
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"map.exr", "model.glb", "report.json"}));
  EXPECT_THAT(some.out, HasSubstr(": map.exr model.glb report.json\n"));
  // The list ends with its comma-separated words: what follows is another argument.
  const Outcome none =
      run_sdm({"map", "--write", "none", o1, o2, "-o", out, "--resolution", "128", "--json"});
  EXPECT_EQ(none.code, 0) << none.err;
  EXPECT_EQ(names_in(out), std::vector<std::string>{"report.json"});
  EXPECT_EQ(Json::parse(none.out)["distance"], Json::parse(report)["distance"]);
  EXPECT_EQ(run_sdm(map({"--write", "none,exr"})).code, 2);
  const Outcome bad = run_sdm(map({"--write", "exr,jpg"}));
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("jpg is not one of views, exr, png, glb, "));
  EXPECT_THAT(bad.err, HasSubstr("texture, ply, csv, npy, vtp, none"));

  EXPECT_EQ(run_sdm(map({"--write", "views", "--both", "--tolerance", "9"})).code, 0);
  for (const std::string body : {"/o1", "/o2"})
    EXPECT_EQ(names_in(out + body), (std::vector<std::string>{"report.json", "views.png"}));
}

// Also of STL, which repeats vertices, and of vertices without a face: against the reference engine.
TEST_F(MapCommand, WritesTheDistancesOfTheInputsVertices) {
  const Mesh mesh = ring(12);
  std::ofstream(o1, std::ios::app) << "v 9 9 9\nv 1 1 1\n";
  std::string stl = "solid ring\n";
  for (const Triangle& t : mesh.triangles) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t)
      stl +=
          fmt::format("vertex {} {} {}\n", mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
    stl += "endloop\nendfacet\n";
  }
  const std::string as_stl = folder / "first.stl";
  std::ofstream(as_stl) << stl << "endsolid\n";

  const Sites sites(moved(read_mesh(o2), {0, 0.25, 0}));
  const MapOptions reference{.engine = make_engine("reference")};
  const std::vector<float> of_mesh = distances_at_vertices(mesh, sites, reference);
  std::vector<float> of_obj = of_mesh, of_stl;
  of_obj.insert(of_obj.end(), 2, std::nanf(""));
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) of_stl.push_back(of_mesh[v]);
  for (const auto& [file, expected] : {std::pair(o1, of_obj), std::pair(as_stl, of_stl)}) {
    const Outcome run = run_sdm({"map", file, o2, "-o", out, "--resolution", "128", "--transform-o2",
                                 "translate:0:0.25:0", "--write", "csv,npy,ply,vtp"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(names_in(out), (std::vector<std::string>{"report.json", "vertices.csv", "vertices.npy",
                                                       "vertices.ply", "vertices.vtp"}));
    const std::string bytes = contents(out + "/vertices.npy");
    ASSERT_EQ(bytes.size(), 128 + 4 * expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v) {
      float found = 0;
      std::memcpy(&found, bytes.data() + 128 + 4 * v, 4);
      if (std::isnan(expected[v]))
        ASSERT_TRUE(std::isnan(found)) << v;
      else
        ASSERT_NEAR(found, expected[v], 1e-6) << v;
    }
  }
  EXPECT_EQ(run_sdm(map()).code, 0);
  EXPECT_EQ(names_in(out), kResults) << "those of the earlier run are removed";
  EXPECT_EQ(run_sdm({"self", o1, "-o", out, "--resolution", "128", "--write", "csv"}).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"report.json", "vertices.csv"}));
  EXPECT_EQ(run_sdm(map({"--write", "exr", "--channels", "distance,position,closest"})).code, 0);
  EXPECT_EQ(run_sdm(map({"--channels", "depth"})).code, 2);
}

/// With these texture coordinates: the height field's, scaled and moved.
std::string write_obj_with_uvs(const std::filesystem::path& file, double scale, double offset) {
  const Mesh mesh = height_field(8);
  std::ofstream out(file);
  for (const Vec3& p : mesh.positions) out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const auto& uvs : mesh.corner_uvs)
    for (const Vec2& uv : uvs) out << "vt " << scale * uv[0] + offset << ' ' << scale * uv[1] << '\n';
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    out << 'f';
    for (std::size_t k = 0; k < 3; ++k) out << ' ' << mesh.triangles[f][k] + 1 << '/' << 3 * f + k + 1;
    out << '\n';
  }
  return file.string();
}

TEST_F(MapCommand, UdimTilesHaveAMapEach) {
  write_obj_with_uvs(o1, 2, 0);
  const Outcome run = run_sdm(map({"--atlas", "uv", "--write", "texture,csv", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const std::vector<std::string> tiles{"1001", "1002", "1011", "1012"};
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"1001", "1002", "1011", "1012", "report.json"}));
  const Json reports = Json::parse(run.out);
  EXPECT_EQ(reports.size(), 5u);
  EXPECT_EQ(reports["total"], Json::parse(contents(out + "/report.json")));
  const Json range = Json::parse(contents(out + "/1001/distance_texture.json"));
  for (const std::string& tile : tiles) {
    EXPECT_EQ(names_in(out + "/" + tile),
              (std::vector<std::string>{"distance_texture.json", "distance_texture.png", "report.json",
                                        "vertices.csv"}));
    EXPECT_EQ(reports[tile], Json::parse(contents(out + "/" + tile + "/report.json")));
    EXPECT_EQ(reports[tile]["atlas"]["udim"], std::stoi(tile));
    EXPECT_EQ(Json::parse(contents(out + "/" + tile + "/distance_texture.json")), range)
        << "one scale for all";
  }
  EXPECT_EQ(run_sdm(map({"--atlas", "uv", "--strict-uv"})).code, 1);
  EXPECT_EQ(run_sdm(map({"--atlas", "uv", "--atlas-cache", folder / "cache"})).code, 1);
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_EQ(names_in(out), kResults) << "the tiles of the earlier run are removed";
}

// All numbers are of the whole area, also of faces without a texel.
TEST_F(MapCommand, MeasuresFacesWithoutTexels) {
  o1 = write_obj(folder / "fine.obj", sphere(4));
  const Json coarse = Json::parse(run_sdm(map({"--resolution", "32", "--json", "--tolerance", "0.5"})).out);
  const Json fine = Json::parse(run_sdm(map({"--resolution", "512", "--json", "--tolerance", "0.5"})).out);
  const double share = coarse["atlas"]["area_fraction_without_texels"];
  EXPECT_EQ(share, area_fraction_without_texels(Surface(read_mesh(o1), {.resolution = 32})));
  EXPECT_GT(share, 0.1);
  EXPECT_EQ(fine["atlas"]["area_fraction_without_texels"], 0);
  for (const char* name : {"mean", "rms", "stddev"})
    EXPECT_NEAR(coarse["distance"][name], fine["distance"][name], 0.003) << name;
  EXPECT_NEAR(coarse["tolerance"]["exceeded_area_fraction"], fine["tolerance"]["exceeded_area_fraction"],
              0.01);
}

// The numbers of all tiles are those of one map of the whole mesh with the same texels.
TEST_F(MapCommand, TotalsOfUdimTilesAreThoseOfAllTexels) {
  o2 = write_obj(folder / "cube.obj", moved(cube(0.4), {0.2, 0.3, 0.1}));
  write_obj_with_uvs(o1, 1, 0);
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--atlas", "uv", "--json"});
    return run_sdm(map(more));
  };
  const Json one = Json::parse(run({"--resolution", "256", "--tolerance", "0.3"}).out);
  write_obj_with_uvs(o1, 2, 0);
  const Outcome tiled = run({"--resolution", "128", "--tolerance", "0.3"});
  EXPECT_EQ(tiled.code, 3);
  const Json all = Json::parse(tiled.out);
  const Json& total = all["total"];
  EXPECT_EQ(total["tiles"], (Json{1001, 1002, 1011, 1012}));
  EXPECT_EQ(total["texels_with_value"], one["texels_with_value"]);
  EXPECT_EQ(total["negative_texels"], one["negative_texels"]);
  for (const auto& [key, value] : one["distance"].items())
    if (value.is_number()) {
      EXPECT_NEAR(total["distance"][key], value, 1e-6) << key;
    }
  EXPECT_NEAR(total["extremes"]["min"]["distance"], one["extremes"]["min"]["distance"], 1e-6);
  EXPECT_NEAR(total["extremes"]["max"]["distance"], one["extremes"]["max"]["distance"], 1e-6);
  EXPECT_NEAR(total["error_bound"], one["error_bound"], 1e-6);
  EXPECT_EQ(total["tolerance"]["verdict"], "FAIL");
  EXPECT_NEAR(total["tolerance"]["exceeded_area_fraction"], one["tolerance"]["exceeded_area_fraction"], 1e-6);
  EXPECT_NEAR(total["tolerance"]["area_fractions"]["above"], one["tolerance"]["area_fractions"]["above"],
              1e-6);
  EXPECT_NEAR(total["hausdorff"]["one_sided"]["upper"], one["hausdorff"]["one_sided"]["upper"], 1e-6);
  ASSERT_EQ(total["worst"].size(), 4u);
  const Json& ends = one["extremes"];
  EXPECT_NEAR(std::abs(total["worst"][0]["distance"].get<double>()),
              std::max(-ends["min"]["distance"].get<double>(), ends["max"]["distance"].get<double>()), 1e-6);
  // A tile may pass where another one fails; all must pass.
  std::vector<double> largest;
  for (const Json& worst : total["worst"]) largest.push_back(std::abs(worst["distance"].get<double>()));
  ASSERT_GT(largest[0], largest[3] + 0.02);
  const std::string between = fmt::format("{}", (largest[0] + largest[3]) / 2);
  const Outcome mixed = run({"--resolution", "128", "--tolerance", between});
  EXPECT_EQ(mixed.code, 3);
  std::vector<std::string> verdicts;
  const Json mixed_reports = Json::parse(mixed.out);
  bool is_one_within = false;  // by its closest points
  for (const auto& [tile, report] : mixed_reports.items()) {
    verdicts.push_back(report["tolerance"]["verdict"]);
    is_one_within = is_one_within || report["tolerance"]["exceeded_area_fraction"] == 0;
  }
  EXPECT_EQ(verdicts.back(), "FAIL");
  EXPECT_TRUE(is_one_within);
  const Outcome passed = run({"--resolution", "128", "--tolerance", "5"});
  EXPECT_EQ(passed.code, 0);
  EXPECT_EQ(Json::parse(passed.out)["total"]["tolerance"]["verdict"], "PASS");
  EXPECT_THAT(run_sdm(map({"--atlas", "uv", "--tolerance", "5"})).out, HasSubstr("all 4 tiles: "));
  // Both directions: one mesh with tiles, one without.
  o2 = write_obj_with_uvs(folder / "plane.obj", 1, 0);
  const Outcome both = run({"--both"});
  ASSERT_EQ(both.code, 0) << both.err;
  const Json reports = Json::parse(both.out);
  EXPECT_EQ(reports["o1"]["total"]["hausdorff"]["symmetric"], reports["o2"]["hausdorff"]["symmetric"]);
  EXPECT_EQ(reports["o1"]["total"], Json::parse(contents(out + "/o1/report.json")));
  EXPECT_EQ(reports["o2"], Json::parse(contents(out + "/o2/report.json")));
}

// A group is judged over all tiles.
TEST_F(MapCommand, TotalsOfUdimTilesHaveTheVerdictsOnGroups) {
  o2 = write_obj(folder / "cube.obj", moved(cube(0.4), {0.2, 0.3, 0.1}));
  write_obj_with_uvs(o1, 2, 0);
  const std::string faces = contents(o1);
  std::ofstream(o1) << "g all\n" << faces;
  const auto run = [&](const std::string& limits) {
    std::ofstream(folder / "table.csv") << "group,lower,upper\nall," << limits << "\n";
    return run_sdm(map({"--atlas", "uv", "--resolution", "64", "--json", "--tolerance", "0.3", "--write",
                        "none", "--tolerance-table", folder / "table.csv"}));
  };
  const Json failed = Json::parse(run("-0.3,0.3").out)["total"];
  ASSERT_EQ(failed["group_tolerances"]["groups"].size(), 1u);
  const Json& group = failed["group_tolerances"]["groups"][0];
  EXPECT_EQ(failed["group_tolerances"]["verdict"], "FAIL");
  EXPECT_EQ(group["verdict"], "FAIL");
  EXPECT_NEAR(group["exceeded_area_fraction"], failed["tolerance"]["exceeded_area_fraction"], 1e-6);
  EXPECT_EQ(group["lowest"], failed["extremes"]["min"]["distance"]);
  EXPECT_EQ(group["highest"], failed["extremes"]["max"]["distance"]);
  EXPECT_EQ(Json::parse(run("-5,5").out)["total"]["group_tolerances"]["verdict"], "PASS");
}

TEST_F(MapCommand, MapsNeedNotBeSquare) {
  write_obj_with_uvs(o1, 1, 0);
  const Outcome run = run_sdm(map({"--atlas", "uv", "--resolution", "200x48", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["atlas"]["resolution"], 200);
  EXPECT_EQ(report["atlas"]["rows"], 48);
  EXPECT_EQ(report["atlas"]["texels"], 200 * 48);
  // Half of the diagonal of a texel, on a surface that is a little longer than its ground plane.
  EXPECT_GT(report["error_bound"], 0.5 * std::hypot(1 / 200., 1 / 48.));
  EXPECT_LT(report["error_bound"], 0.75 * std::hypot(1 / 200., 1 / 48.));
  EXPECT_EQ(run_sdm(map({"--atlas", "uv", "--resolution", "48x48"})).code, 0);
  EXPECT_EQ(run_sdm(map({"--resolution", "64x64", "--write", "none"})).code, 0);
  for (const char* bad : {"200x", "x48", "200x8", "200x48x3", "200*48", "-200x48", "40000x48", "1e2"})
    EXPECT_EQ(run_sdm(map({"--atlas", "uv", "--resolution", bad})).code, 2) << bad;
  const Outcome charts = run_sdm(map({"--resolution", "200x48"}));
  EXPECT_EQ(charts.code, 2);
  EXPECT_THAT(charts.err, HasSubstr("needs --atlas uv"));
  EXPECT_EQ(run_sdm({"sequence", o1, o2, "-o", out, "--resolution", "200x48"}).code, 2);
}

TEST_F(MapCommand, TextureCoordinatesAreWrapped) {
  write_obj_with_uvs(o1, 1, 2.3125);  // 296 texels: the same samples
  const Outcome run = run_sdm(map({"--atlas", "uv", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json wrapped = Json::parse(run.out);
  EXPECT_EQ(wrapped["o1"]["triangles"], 128);
  EXPECT_EQ(wrapped["atlas"]["cut_faces"], 16);
  EXPECT_EQ(wrapped["atlas"]["utilisation"], 1);
  EXPECT_EQ(wrapped["atlas"]["overlapping_texels"], 0);
  EXPECT_EQ(wrapped["notes"].size(), 1u);
  EXPECT_EQ(wrapped["components"]["count"], 1);
  write_obj_with_uvs(o1, 1, 0);
  const Json plain = Json::parse(run_sdm(map({"--atlas", "uv", "--json"})).out);
  EXPECT_EQ(plain["atlas"]["cut_faces"], 0);
  for (const char* same : {"min", "max"})
    EXPECT_NEAR(wrapped["distance"][same], plain["distance"][same], 1e-6) << same;
  EXPECT_NEAR(wrapped["distance"]["mean"], plain["distance"]["mean"], 1e-4) << "cut faces share other areas";
  write_obj_with_uvs(o1, 1.5, 0);
  const Json overlapping = Json::parse(run_sdm(map({"--atlas", "uv", "--json"})).out);
  EXPECT_GT(overlapping["atlas"]["overlapping_texels"], 128 * 128);
  EXPECT_EQ(overlapping["notes"].size(), 2u);
  EXPECT_GT(overlapping["atlas"]["area_fraction_without_texels"], 0.001);
}

TEST_F(MapCommand, ALaterRunTakesTheAtlasFromItsCache) {
  const std::string cache = folder / "first.atlas";
  ASSERT_EQ(run_sdm(map({"--atlas-cache", cache})).code, 0);
  const std::string exr = contents(out + "/map.exr"), stored = contents(cache);
  EXPECT_GT(stored.size(), 1000u);
  const Outcome again = run_sdm(map({"--atlas-cache", cache}));
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(contents(out + "/map.exr"), exr);
  EXPECT_EQ(contents(cache), stored);
  EXPECT_EQ(names_in(folder.path()).size(), 4u) << "two meshes, the results and the cache";

  for (const std::vector<std::string>& other : {std::vector<std::string>{"--resolution", "256"},
                                                {"--resolution", "32"},
                                                {"--transform-o1", "scale:2"},
                                                {"--max-stretch", "3"}}) {
    std::vector<std::string> more = other;
    more.insert(more.end(), {"--atlas-cache", cache});
    const Outcome refused = run_sdm(map(more));
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr(cache + ": the stored atlas"));
  }
  EXPECT_EQ(contents(out + "/map.exr"), exr);
  std::ofstream(cache) << "not an atlas";
  EXPECT_THAT(run_sdm(map({"--atlas-cache", cache})).err, HasSubstr(cache + ": it is not a stored atlas"));
  EXPECT_EQ(run_sdm(map({"--atlas-cache", cache, "--both"})).code, 2);
  EXPECT_EQ(run_sdm(map({"--atlas-cache", folder.path().string()})).code, 1);
}

TEST_F(MapCommand, ReportHasTheNumbersOfTheLibrary) {
  const Outcome run = run_sdm(map({"--json", "--units", "mm", "--threads", "1"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, contents(out + "/report.json"));
  const Json report = Json::parse(run.out);

  const Surface surface(read_mesh(o1), {.resolution = 128});
  const Sites sites(read_mesh(o2));
  const DistanceMap map = compute_map(surface, sites);
  const DistanceStatistics expected = statistics(surface, map);
  EXPECT_EQ(report["version"], kVersion);
  EXPECT_EQ(report["units"], "mm");
  EXPECT_EQ(report["engine"], "cpu");
  EXPECT_EQ(report["measured_on"], "o1");
  EXPECT_EQ(report["o1"]["file"], o1);
  EXPECT_EQ(report["o1"]["xxh3"], file_xxh3(o1));
  EXPECT_EQ(report["o2"]["xxh3"], file_xxh3(o2));
  EXPECT_EQ(report["o1"]["vertices"], 144);
  EXPECT_EQ(report["o1"]["triangles"], 288);
  EXPECT_EQ(report["o2"]["triangles"], 512);
  EXPECT_EQ(report["o2"]["closed"], true);
  EXPECT_EQ(report["o2"]["degenerate_faces"], 0);
  EXPECT_EQ(report["atlas"]["kind"], "charts");
  EXPECT_EQ(report["atlas"]["resolution"], 128);
  EXPECT_EQ(report["atlas"]["charts"], surface.chart_count());
  EXPECT_EQ(report["atlas"]["texels"], surface.owned_texels());
  EXPECT_EQ(report["atlas"]["utilisation"], surface.utilisation());
  EXPECT_EQ(report["atlas"]["max_stretch"], surface.max_stretch());
  const PictureOptions colors = fixed_colors({.accuracy = report["accuracy"]}, expected);
  EXPECT_EQ(report["colors"]["map"], "diverging");
  EXPECT_EQ(report["colors"]["range"], Json(*colors.range));
  EXPECT_EQ(report["colors"]["range_from"], "p99_abs");
  EXPECT_EQ(report["sign"]["method"], "exact");
  EXPECT_EQ(report["sign"]["reason"], map.sign.reason);
  EXPECT_EQ(report["distance"]["kind"], "estimate");
  const std::vector<std::pair<std::string, double>> distances{
      {"min", expected.min}, {"max", expected.max}, {"mean", expected.mean}, {"rms", expected.rms},
      {"p50", expected.p50}, {"p95", expected.p95}, {"p99", expected.p99}};
  for (const auto& [key, value] : distances) EXPECT_NEAR(report["distance"][key], value, 1e-6) << key;
  EXPECT_EQ(report["negative_texels"], expected.negative_texels);
  EXPECT_GT(expected.negative_texels, 0u);
  EXPECT_EQ(report["texels_with_value"], expected.texels);
  EXPECT_EQ(report["beyond_max_distance"], 0);
  EXPECT_TRUE(report["max_distance"].is_null());
  EXPECT_EQ(report["error_bound"], covering_radius(surface));
  EXPECT_EQ(report["error_bound_kind"], "bounded");
  for (const char* step : {"import", "atlas", "sites", "map", "export", "total"})
    EXPECT_GT(report["time_ms"][step], 0) << step;
  EXPECT_FALSE(report.contains("tolerance"));
}

TEST_F(MapCommand, PrecisionPicksTheResolutionOfEachMap) {
  EXPECT_TRUE(Json::parse(run_sdm(map({"--json"})).out)["precision"].is_null());
  const Outcome run = run_sdm(map({"--precision", "0.05", "--both", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json reports = Json::parse(run.out);
  for (const char* mesh : {"o1", "o2"}) {
    const Json& report = reports[mesh];
    EXPECT_EQ(report["precision"], 0.05);
    EXPECT_LE(report["error_bound"], 0.05);
    EXPECT_EQ(report["atlas"]["resolution"].get<int>() % 16, 0);
  }
  const Json fine = Json::parse(run_sdm(map({"--precision", "0.01", "--json"})).out);
  EXPECT_LE(fine["error_bound"], 0.01);
  EXPECT_GT(fine["atlas"]["resolution"], reports["o1"]["atlas"]["resolution"]);
}

TEST_F(MapCommand, PrecisionOutOfReachFailsAndTellsWhatIsNot) {
  const Outcome run = run_sdm(map({"--precision", "1e-9"}));
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("times the maximum of 32768 texels per side; use 0.00"));
}

TEST_F(MapCommand, BothMeasuresEitherWay) {
  const Outcome run = run_sdm(map({"--both", "--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"o1", "o2"}));
  EXPECT_EQ(names_in(out + "/o1"), kResults);
  EXPECT_EQ(names_in(out + "/o2"), kResults);
  const Json reports = Json::parse(run.out);
  EXPECT_EQ(reports["o1"]["measured_on"], "o1");
  EXPECT_EQ(reports["o2"]["measured_on"], "o2");
  EXPECT_EQ(reports["o2"]["o1"]["file"], o1);
  EXPECT_EQ(reports["o2"], Json::parse(contents(out + "/o2/report.json")));
  // The other way round is another surface.
  EXPECT_NE(reports["o1"]["atlas"], reports["o2"]["atlas"]);

  const Outcome swapped = run_sdm({"map", o2, o1, "-o", folder / "swapped", "--resolution", "128", "--json"});
  EXPECT_EQ(Json::parse(swapped.out)["distance"], reports["o2"]["distance"]);
}

TEST_F(MapCommand, ExceededToleranceEndsWithThreeAndStillWrites) {
  const Outcome run = run_sdm(map({"--tolerance", "0.05", "--json"}));
  EXPECT_EQ(run.code, 3);
  EXPECT_EQ(names_in(out), kResults);
  const Json tolerance = Json::parse(run.out)["tolerance"];
  EXPECT_EQ(tolerance["value"], 0.05);
  EXPECT_EQ(tolerance["within"], false);
  EXPECT_EQ(tolerance["certified"], true);
  EXPECT_GT(tolerance["exceeded_area_fraction"], 0.1);
  EXPECT_LT(tolerance["exceeded_area_fraction"], 1);
}

TEST_F(MapCommand, AToleranceMayDifferByTheSign) {
  const Outcome run = run_sdm(map({"--tolerance", "-.5:.05", "--json"}));
  EXPECT_EQ(run.code, 3);
  const Json report = Json::parse(run.out), tolerance = report["tolerance"];
  EXPECT_TRUE(tolerance["value"].is_null());
  EXPECT_EQ(tolerance["lower"], -0.5);
  EXPECT_EQ(tolerance["upper"], 0.05);
  EXPECT_EQ(tolerance["verdict"], "FAIL");
  EXPECT_EQ(tolerance["area_fractions"]["below"], 0);
  EXPECT_EQ(tolerance["area_fractions"]["above"], tolerance["exceeded_area_fraction"]);
  // By default, a limit is the edge of a band.
  double within = 0, all = 0;
  for (const Json& band : report["bands"]) {
    all += band["area_fraction"].get<double>();
    if (!band["lower"].is_null() && !band["upper"].is_null() && band["lower"] >= -0.5 &&
        band["upper"] <= 0.05)
      within += band["area_fraction"].get<double>();
  }
  EXPECT_NEAR(within, tolerance["area_fractions"]["within"].get<double>(), 1e-12);
  EXPECT_NEAR(all, 1, 1e-12);
  EXPECT_THAT(run_sdm(map({"--tolerance", "-0.5:0.05"})).out, HasSubstr("FAIL: "));
  EXPECT_THAT(run_sdm(map({"--tolerance", "-5:3"})).out, HasSubstr("PASS: "));

  const Outcome refused = run_sdm(map({"--tolerance", "-0.5:0.05", "--sign", "none"}));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("unsigned"));
  EXPECT_EQ(run_sdm(map({"--tolerance", "0:5", "--sign", "none"})).code, 0);
}

TEST_F(MapCommand, ReportHasBandsAHistogramAndHausdorffBounds) {
  const Json report = Json::parse(run_sdm(map({"--bands", "-0.1,0,0.2", "--json"})).out);
  EXPECT_EQ(report["bands"].size(), 4u);
  EXPECT_EQ(report["bands"][1]["lower"], -0.1);
  const Json& histogram = report["histogram"];
  double all = histogram["below"].get<double>() + histogram["above"].get<double>();
  for (const Json& bin : histogram["area_fractions"]) all += bin.get<double>();
  EXPECT_NEAR(all, 1, 1e-9);
  EXPECT_EQ(report["components"]["count"], 1);

  const Json both = Json::parse(run_sdm(map({"--both", "--json"})).out);
  const Json &a = both["o1"]["hausdorff"], &b = both["o2"]["hausdorff"];
  EXPECT_EQ(Json::parse(contents(out + "/o1/report.json"))["hausdorff"], a);
  EXPECT_EQ(a["symmetric"], b["symmetric"]);
  for (const char* key : {"lower", "upper"})
    EXPECT_EQ(a["symmetric"][key].get<double>(),
              std::max(a["one_sided"][key].get<double>(), b["one_sided"][key].get<double>()));
  // A finer map is within the bounds of a coarse one.
  const Json fine =
      Json::parse(run_sdm(map({"--resolution", "1024", "--json"})).out)["hausdorff"]["one_sided"];
  EXPECT_LE(fine["upper"], a["one_sided"]["upper"]);
  EXPECT_GE(fine["lower"], a["one_sided"]["lower"]);
  EXPECT_LT(fine["lower"], fine["upper"]);
}

TEST_F(MapCommand, PartsHaveStatisticsOfTheirOwn) {
  Mesh mesh = joined(ring(12), moved(ring(8), {9, 0, 0}));
  write_obj(o1, mesh);
  std::string text = contents(o1);
  text.insert(text.find("f "), "usemtl steel\n");
  std::ofstream(o1) << text << "usemtl rubber\nf 1 2 3\n";
  const Json report = Json::parse(run_sdm(map({"--tolerance", "1", "--json"})).out);
  EXPECT_EQ(report["components"]["count"], 2);
  const Json& rows = report["components"]["largest"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0]["area_fraction"].get<double>() + rows[1]["area_fraction"].get<double>(), 1, 1e-9);
  EXPECT_LT(rows[0]["distance"]["max"], 2);
  EXPECT_GT(rows[1]["distance"]["min"], 5);
  EXPECT_EQ(rows[1]["tolerance"]["above"], 1);
  ASSERT_EQ(report["groups"].size(), 1u);
  EXPECT_EQ(report["groups"][0]["kind"], "material");
  EXPECT_EQ(report["groups"][0]["count"], 2);
  EXPECT_EQ(report["groups"][0]["largest"][0]["name"], "steel");
  EXPECT_EQ(report["groups"][0]["largest"][1]["triangles"], 1);
}

TEST_F(MapCommand, KeptToleranceIsCertifiedByTheErrorBoundOrAProof) {
  const Json plain = Json::parse(run_sdm(map({"--json"})).out);
  const double largest =
      std::max(std::abs(plain["distance"]["min"].get<double>()), plain["distance"]["max"].get<double>());
  const double bound = plain["error_bound"];
  for (const bool certified : {true, false}) {
    // Vertices are looked at too, and lie at most the bound away from a texel.
    const double tolerance = largest + (certified ? 2.01 : 1.0) * bound;
    const Outcome run = run_sdm(map({"--json", "--tolerance", std::to_string(tolerance)}));
    EXPECT_EQ(run.code, 0);
    const Json verdict = Json::parse(run.out)["tolerance"];
    EXPECT_EQ(verdict["within"], true);
    EXPECT_EQ(verdict["exceeded_area_fraction"], 0);
    EXPECT_EQ(verdict["certified"], true);
    const bool thin = !verdict["by_facing"].is_null();
    EXPECT_EQ(verdict["proof"].is_null(), certified && !thin) << "where the map decides, nothing else runs";
  }
  const Outcome run = run_sdm(map({"--json", "--tolerance", std::to_string(largest + 1e-6)}));
  EXPECT_EQ(Json::parse(run.out)["tolerance"]["certified"], run.code != 4) << "a proof decides, if anything";
}

TEST_F(MapCommand, TexelsBeyondTheMaximumDistanceAreCounted) {
  const Json all = Json::parse(run_sdm(map({"--json"})).out);
  const Outcome run = run_sdm(map({"--json", "--max-distance", "0.1", "--range", "-0.2", "0.3"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["max_distance"], 0.1);
  EXPECT_GT(report["beyond_max_distance"], 0);
  EXPECT_GT(report["texels_with_value"], 0);
  EXPECT_EQ(report["beyond_max_distance"].get<int>() + report["texels_with_value"].get<int>(),
            all["texels_with_value"]);
  EXPECT_LE(report["distance"]["max"], 0.1);
}

TEST_F(MapCommand, AMapWithoutAnyValueIsReportedWithNulls) {
  const Outcome run =
      run_sdm(map({"--json", "--max-distance", "0.001", "--transform-o2", "translate:50:0:0"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["texels_with_value"], 0);
  EXPECT_TRUE(report["distance"]["mean"].is_null());
  EXPECT_EQ(report["o2"]["transform"], "translate:50:0:0");
  EXPECT_EQ(names_in(out), kResults);
  EXPECT_EQ(
      run_sdm(map({"--max-distance", "0.001", "--tolerance", "0.001", "--transform-o2", "translate:50:0:0"}))
          .code,
      3);
}

TEST_F(MapCommand, EnginesAtlasesAndSignsCanBeChosen) {
  const Json cpu = Json::parse(run_sdm(map({"--json"})).out);
  const Json reference = Json::parse(run_sdm(map({"--json", "--engine", "reference"})).out);
  EXPECT_EQ(reference["engine"], "reference");
  EXPECT_NEAR(cpu["distance"]["mean"], reference["distance"]["mean"], 1e-6);
  const Json triangles = Json::parse(run_sdm(map({"--json", "--atlas", "triangles"})).out);
  EXPECT_EQ(triangles["atlas"]["kind"], "triangles");
  EXPECT_GE(triangles["atlas"]["charts"], 288 / 2);  // pairs of faces, and what is left over
  EXPECT_LT(triangles["atlas"]["charts"], 288);
  const Json unsigned_map = Json::parse(run_sdm(map({"--json", "--sign", "none"})).out);
  EXPECT_EQ(unsigned_map["sign"]["method"], "none");
  EXPECT_EQ(unsigned_map["negative_texels"], 0);
  EXPECT_EQ(Json::parse(run_sdm(map({"--json", "--sign", "winding"})).out)["sign"]["method"], "exact")
      << "closed";
}

TEST_F(MapCommand, RunsAgainOverEarlierResultsAndKeepsOtherFiles) {
  ASSERT_EQ(run_sdm(map()).code, 0);
  std::ofstream(out + "/notes.txt") << "mine";
  const std::string before = contents(out + "/map.exr");
  ASSERT_EQ(run_sdm(map({"--transform-o2", "translate:0.5:0:0"})).code, 0);
  EXPECT_NE(contents(out + "/map.exr"), before);
  EXPECT_EQ(contents(out + "/notes.txt"), "mine");
  EXPECT_EQ(names_in(out).size(), kResults.size() + 1);
}

TEST_F(MapCommand, QuietIsQuietAndATerminalSeesProgress) {
  const Outcome quiet = run_sdm(map({"--quiet"}), {.terminal = true});
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Outcome shown = run_sdm(map(), {.terminal = true});
  EXPECT_THAT(shown.err, HasSubstr("map"));
  EXPECT_THAT(shown.err, HasSubstr(" %"));
  EXPECT_THAT(shown.err, ::testing::EndsWith("\r\033[K")) << "the line is removed at the end";
  EXPECT_THAT(shown.err, Not(HasSubstr("\n")));
}

TEST_F(MapCommand, FlawedFacesAreToleratedAndCounted) {
  Mesh mesh = ring(10);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back(mesh.triangles[3]);
  write_obj(o1, mesh);
  const Outcome run = run_sdm(map({"--json"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["o1"]["degenerate_faces"], 1);
  EXPECT_EQ(report["o1"]["duplicate_faces"], 1);
}

}  // namespace
}  // namespace sdm::test
