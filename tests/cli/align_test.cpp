// `--align` of `sdm map` and `sdm proximity`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/meshes.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// A mesh, and the same moved away.
struct AlignOption : ::testing::Test {
  TemporaryFolder folder;
  Mesh mesh = joined(cube(1), ring(16, 0.5, {0.9, 0.4, 0.2}));
  std::string o2 = write_obj(folder / "part.obj", mesh);
  std::string o1 = write_obj(folder / "scan.obj", placed(mesh, "rotate:1:-2:1,translate:0.04:0.02:-0.03"));
  std::string out = folder / "out";

  Outcome map(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"map", o1, o2, "-o", out, "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

TEST_F(AlignOption, MovesO1AndWritesTheMatrix) {
  const Outcome run = map({"--align", "--units", "mm"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("aligned   turned O1 by 2."));
  EXPECT_THAT(run.out, HasSubstr(": alignment.json views.png map.exr"));
  EXPECT_THAT(run.out, Not(HasSubstr("O2")));
  const Json report = Json::parse(contents(out + "/report.json"));
  const Json alignment = Json::parse(contents(out + "/alignment.json"));
  EXPECT_EQ(report["alignment"], alignment);
  EXPECT_LT(report["extremes"]["max"]["distance"], 1e-12);
  EXPECT_EQ(alignment["converged"], true);
  EXPECT_EQ(alignment["from"], "auto");
  EXPECT_EQ(alignment["degrees_of_freedom"].size(), 6u);
  EXPECT_EQ(alignment["degrees_of_freedom"][5]["free"], false);
  EXPECT_GT(alignment["before"]["rms"], 0.01);
  EXPECT_LT(alignment["after"]["rms"], 1e-12);
  EXPECT_NEAR(alignment["rotation_degrees"], 2.45, 0.1);
}

// The placed mesh is the same to the last bit, so that maps can be repeated without an alignment.
TEST_F(AlignOption, TheMatrixCanBeReadBack) {
  ASSERT_EQ(map({"--align"}).code, 0);
  // The second half of map.exr is nothing but texels; its header names the transform.
  const auto texels = [&, half = contents(out + "/map.exr").size() / 2] {
    const std::string exr = contents(out + "/map.exr");
    return exr.substr(exr.size() - half);
  };
  const std::string expected = texels();
  const std::string file = folder / "found.json", report = folder / "found-report.json";
  std::filesystem::copy_file(out + "/alignment.json", file);
  std::filesystem::copy_file(out + "/report.json", report);
  for (const std::string& from : {file, report}) {
    const Outcome run = map({"--transform-o1", "matrix:" + from});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_TRUE(texels() == expected);
    EXPECT_FALSE(std::filesystem::exists(out + "/alignment.json")) << "of the earlier run";
  }
  const Outcome again = map({"--align", "--align-from", file, "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  const Json json = Json::parse(again.out);
  EXPECT_EQ(json["alignment"]["from"], file);
  EXPECT_EQ(json["alignment"]["iterations"], 2);
}

TEST_F(AlignOption, BothMapsAreOfTheAlignedMesh) {
  const Outcome run = map({"--align", "--both", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json reports = Json::parse(run.out);
  EXPECT_LT(reports["o1"]["extremes"]["max"]["distance"], 1e-12);
  EXPECT_LT(reports["o2"]["extremes"]["max"]["distance"], 1e-12);
  EXPECT_EQ(reports["o1"]["alignment"], reports["o2"]["alignment"]);
  EXPECT_TRUE(std::filesystem::exists(out + "/alignment.json"));
}

TEST_F(AlignOption, BothPagesAreNamed) {
  const Outcome run = map({"--align", "--both", "--write", "html"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* role : {"o1", "o2"}) {
    const std::string page = out + "/" + role + "/report.html";
    EXPECT_THAT(run.out, HasSubstr(page + "\n"));
    EXPECT_TRUE(std::filesystem::exists(page));
  }
}

TEST_F(AlignOption, FromPrincipalAxes) {
  o1 = write_obj(folder / "turned.obj", placed(mesh, "rotate:40:100:-70,translate:9:8:7"));
  const Outcome far = map({"--align", "--align-from", "none"});
  EXPECT_EQ(far.code, 0) << far.err;
  EXPECT_THAT(far.out, HasSubstr("--align-from pca?"));
  const Outcome run = map({"--align", "--align-from", "pca", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_LT(Json::parse(run.out)["extremes"]["max"]["distance"], 1e-12);
  const Outcome tried = map({"--align", "--json"});
  ASSERT_EQ(tried.code, 0) << tried.err;
  EXPECT_LT(Json::parse(tried.out)["extremes"]["max"]["distance"], 1e-12);
}

TEST_F(AlignOption, NotesSayWhatIsNotDetermined) {
  o1 = write_obj(folder / "a.obj", placed(sphere(3), "translate:0.1:0:0"));
  o2 = write_obj(folder / "b.obj", sphere(3));
  const Outcome run = map({"--align", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_THAT(json["notes"].dump(), HasSubstr("the surfaces do not determine the alignment"));
  EXPECT_THAT(json["notes"].dump(), HasSubstr("rotation about"));
  EXPECT_TRUE(json["alignment"]["degrees_of_freedom"][3]["free"]);
  EXPECT_TRUE(json["alignment"]["degrees_of_freedom"][3]["standard_error"].is_null());
}

TEST_F(AlignOption, OfProximity) {
  const Outcome run = run_sdm({"proximity", o1, o2, "--align", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_LT(json["alignment"]["after"]["rms"], 1e-12);
  EXPECT_EQ(json["notes"], Json::array());
  EXPECT_THAT(run_sdm({"proximity", o1, o2, "--align"}).out, HasSubstr("aligned "));
}

TEST_F(AlignOption, NumbersAreReadStrictly) {
  const auto code = [&](const std::vector<std::string>& options) { return map(options).code; };
  for (const char* number : {"+-1", "-+1", "++1", "0x1", "1,", "nan", "1e999", "one"}) {
    for (const char* option : {"--tolerance", "--weld", "--facing", "--max-distance", "--ignore-islands"})
      EXPECT_EQ(code({option + std::string("=") + number}), 2) << option << " " << number;
    EXPECT_EQ(code({"--along", std::string("1,0,") + number}), 2) << number;
    EXPECT_EQ(code({"--align", "--align-free", "x", "--align-about", std::string("0,0,") + number}), 2)
        << number;
    EXPECT_EQ(code({"--align", "--align-on", std::string("box:0,0,0,1,1,") + number}), 2) << number;
  }
  for (const char* list : {"0,0,0", "1,2", "1,2,3,4", "1,,2,3", ",1,2,3", "1;2;3"})
    EXPECT_EQ(code({"--along", list}), 2) << list;
  for (const char* list : {"1,2", "1,,2,3", "1,2,3,", "1 2 3"})
    EXPECT_EQ(code({"--align", "--align-free", "x", "--align-about", list}), 2) << list;
  EXPECT_EQ(code({"--along", "+1,-0,1e-3"}), 0);
  EXPECT_EQ(code({"--along", "1e200,0,0"}), 0);
  EXPECT_EQ(code({"--align", "--align-free", "x", "--align-about", "+1,-2.5,1e3"}), 0);
}

TEST_F(AlignOption, LockedFreedomsAreNotUsed) {
  const Outcome run = map({"--align", "--align-free", "xy,rz", "--align-about", "0.1,0.2,-1", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json alignment = Json::parse(run.out)["alignment"];
  EXPECT_EQ(alignment["allowed"], (Json{"x", "y", "rz"}));
  EXPECT_EQ(alignment["about"], (Json{0.1, 0.2, -1.0}));
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(alignment["matrix"][2][k], k == 2 ? 1 : 0, 1e-15);
  EXPECT_EQ(alignment["degrees_of_freedom"][3]["locked"], true);
  EXPECT_GT(alignment["after"]["rms"], 1e-4);
  EXPECT_THAT(map({"--align", "--align-free", "xy,rz"}).out, HasSubstr("by x, y, rz only"));
  EXPECT_EQ(map({"--align", "--align-free", "xw"}).code, 2);
  EXPECT_EQ(map({"--align", "--align-about", "0,0,0"}).code, 2) << "without --align-free";
  EXPECT_EQ(map({"--align-free", "x"}).code, 2) << "without --align";
}

/// The mesh with its top as the group "datum" and all else as "rest".
std::string write_groups(const std::string& file, const Mesh& mesh) {
  std::ofstream out(file);
  out.precision(17);
  for (const Vec3& p : mesh.positions) out << "v " << p[0] << " " << p[1] << " " << p[2] << "\n";
  for (const bool datum : {true, false}) {
    out << (datum ? "g datum\n" : "g rest\n");
    for (const Triangle& t : mesh.triangles) {
      const bool top =
          mesh.positions[t[0]][2] > 0.9 && mesh.positions[t[1]][2] > 0.9 && mesh.positions[t[2]][2] > 0.9;
      if (top == datum) out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    }
  }
  return file;
}

TEST_F(AlignOption, OnGroupsAndBoxes) {
  o2 = write_groups(folder / "groups.obj", mesh);
  const Outcome run = map({"--align", "--align-on", "datum", "--align-on", "box:-2,-2,-2,0,2,2", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json alignment = Json::parse(run.out)["alignment"];
  EXPECT_EQ(alignment["on"], (Json{"datum", "box:-2,-2,-2,0,2,2"}));
  EXPECT_LT(alignment["samples"], 32768);
  EXPECT_LT(alignment["after"]["rms"], 1e-12);
  EXPECT_EQ(alignment["group_kind"], "group");
  ASSERT_EQ(alignment["groups"].size(), 2u);
  EXPECT_GE(alignment["groups"][0]["rms"], alignment["groups"][1]["rms"]);
  EXPECT_THAT(map({"--align"}).out, HasSubstr("group datum: residual rms"));
  EXPECT_THAT(map({"--align", "--align-on", "datum"}).out, HasSubstr("on datum ("));
  EXPECT_THAT(alignment["text"].get<std::string>(), HasSubstr(R"(on "datum", "box:-2,-2,-2,0,2,2" ()"));
  const Outcome unknown = map({"--align", "--align-on", "datums"});
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("has the name 'datums'; its names are datum, rest"));
  EXPECT_EQ(map({"--align", "--align-on", "box:1,2,3"}).code, 2);
  // One plane determines three motions, and says so.
  EXPECT_THAT(map({"--align", "--align-on", "datum"}).out, HasSubstr("do not determine"));
}

TEST_F(AlignOption, ByPrimarySecondaryAndTertiaryPoints) {
  const std::string file = folder / "points.txt";
  std::ofstream(file) << "# of O1, and on O2\n0 0 1  0 0 2\n1 0 1, 1 0 2\n0 1 1; 0 1 2\n"
                         "0 -1 0  0 -1 1\n1 -1 0  1 -1 1\n1 0 0  1.5 0 1\n";
  const Outcome run = map({"--align-321", file, "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json alignment = Json::parse(run.out)["alignment"];
  EXPECT_EQ(alignment["from"], "321");
  EXPECT_EQ(alignment["points"], file);
  const Transform expected = Transform::translation({0.5, 0, 1});
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(alignment["matrix"][i][k], expected.rows[i][k], 1e-15);
  EXPECT_EQ(map({"--align-321", file, "--align"}).code, 2);
  std::ofstream(file) << "0 0 1  0 0 2\n";
  EXPECT_THAT(map({"--align-321", file}).err, HasSubstr("needs six rows"));
  std::ofstream(file) << "0 0 1  0 0\n";
  EXPECT_THAT(map({"--align-321", file}).err, HasSubstr("line 1 is not six numbers"));
  EXPECT_THAT(map({"--align-321", folder / "none.txt"}).err, HasSubstr("no such file"));
}

TEST_F(AlignOption, AMirroredPartIsDoubtful) {
  o1 = write_obj(folder / "mirrored.obj", placed(joined(cube(1), ring(16, 0.5, {0.9, 0.4, 0.2})), ""));
  const std::string file = folder / "mirror.txt";
  std::ofstream(file) << "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::string mirror = "matrix:" + file;
  const Outcome run = map({"--transform-o1", mirror, "--align", "--tolerance", "2", "--json"});
  EXPECT_EQ(run.code, 5) << run.out;
  const Json report = Json::parse(run.out);
  ASSERT_FALSE(report["doubts"].empty());
  EXPECT_EQ(report["doubts"][0]["reason"], "mirrored");
  EXPECT_LT(report["alignment"]["mirrored"]["misfit"],
            0.25 * report["alignment"]["mirrored"]["misfit_as_given"].get<double>());
  EXPECT_THAT(map({"--transform-o1", mirror, "--align"}).out, HasSubstr("far better mirrored"));
}

TEST_F(AlignOption, AScaledPartIsNoted) {
  const Outcome run = map({"--transform-o1", "scale:0.98", "--align", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_NEAR(report["alignment"]["scale"]["factor"], 1 / 0.98, 1e-6);
  EXPECT_THAT(report["notes"].dump(), HasSubstr("times as large"));
  EXPECT_TRUE(Json::parse(map({"--align", "--json"}).out)["alignment"]["scale"].is_null());
}

TEST_F(AlignOption, FaultsOfTheMatrix) {
  const std::string file = folder / "pose.txt";
  const auto fault = [&](const std::vector<std::string>& options) {
    const Outcome run = map(options);
    EXPECT_EQ(run.code, 1);
    EXPECT_FALSE(std::filesystem::exists(out));
    return run.err;
  };
  const std::vector<std::string> start{"--align", "--align-from", file},
      place{"--transform-o1", "fit,matrix:" + file};
  EXPECT_THAT(fault(start), HasSubstr(file + ": there is no such file"));
  EXPECT_THAT(fault(place), HasSubstr(file + ": there is no such file"));
  std::ofstream(file) << "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n";
  EXPECT_THAT(fault(start), HasSubstr(file + ": the pose to start the alignment at is not a rotation"));
  EXPECT_EQ(map(place).code, 0) << "any affine map will do";
  std::filesystem::remove_all(out);
  std::ofstream(file) << "1 0 0\n";
  EXPECT_THAT(fault(start), HasSubstr("has 3 numbers, not 16"));
  EXPECT_THAT(fault(place), HasSubstr("has 3 numbers, not 16"));
  EXPECT_EQ(map({"--align-from", "pca"}).code, 2) << "without --align";
  EXPECT_EQ(map({"--transform-o1", "matrix:"}).code, 2);
}

// A reflection keeps the outside of a mesh outside.
TEST_F(AlignOption, AMatrixMayReflect) {
  const std::string file = folder / "mirror.txt";
  std::ofstream(file) << "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  o1 = o2;
  const Outcome run = map({"--transform-o1", "matrix:" + file, "--transform-o2", "matrix:" + file, "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_LT(Json::parse(run.out)["extremes"]["max"]["distance"], 1e-12);
}

}  // namespace
}  // namespace sdm::test
