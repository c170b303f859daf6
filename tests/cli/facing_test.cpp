// --facing and --sign side of whole jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/samples.h"
#include "support/meshes.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// 20 × 20 × 0.5 units, of a cube of size 2.
Mesh flat(Mesh mesh) {
  for (Vec3& p : mesh.positions) p = {10 * p[0], 10 * p[1], 0.25 * p[2]};
  return mesh;
}

/// A sheet of 20 × 20 × 1 with a pit in its upper side, one cell wide.
Mesh sheet(double depth) {
  constexpr std::uint32_t n = 10;
  Mesh mesh;
  const auto vertex = [](bool top, std::uint32_t i, std::uint32_t j) {
    return (top ? (n + 1) * (n + 1) : 0) + i * (n + 1) + j;
  };
  for (const double z : {-0.5, 0.5})
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j)
        mesh.positions.push_back({2.0 * i - n, 2.0 * j - n, z - (z > 0 && i == 5 && j == 5 ? depth : 0)});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      quad(vertex(true, i, j), vertex(true, i + 1, j), vertex(true, i + 1, j + 1), vertex(true, i, j + 1));
      quad(vertex(false, i, j), vertex(false, i, j + 1), vertex(false, i + 1, j + 1),
           vertex(false, i + 1, j));
    }
  const auto wall = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
    quad(vertex(false, i, j), vertex(false, k, l), vertex(true, k, l), vertex(true, i, j));
  };
  for (std::uint32_t k = 0; k < n; ++k) {
    wall(k, 0, k + 1, 0);
    wall(n, k, n, k + 1);
    wall(n - k, n, n - k - 1, n);
    wall(0, n - k, 0, n - k - 1);
  }
  return mesh;
}

struct FacingJobs : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out";
  std::string plate = write_obj(folder / "plate.obj", flat(cube()));
  // Inside the plate, below its middle: a dent of its upper side.
  std::string dent = write_obj(folder / "dent.obj", square(1, -0.2));

  [[nodiscard]] Outcome run(const std::string& command, const std::string& o1,
                            std::vector<std::string> more) const {
    std::vector<std::string> arguments{command, o1, plate, "-o", out, "--write", "none"};
    if (command == "map") arguments.insert(arguments.end(), {"--resolution", "32"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
  [[nodiscard]] std::string cloud(bool normals) const {
    std::ofstream file(folder / "cloud.xyz");
    for (int i = 0; i < 8; ++i) file << 0.1 * i << " 0.5 -0.2" << (normals ? " 0 0 1\n" : "\n");
    return folder / "cloud.xyz";
  }
};

TEST_F(FacingJobs, StateWhatIsMeasured) {
  EXPECT_THAT(run("map", dent, {}).out, Not(HasSubstr("measured")));
  const Outcome facing = run("map", dent, {"--tolerance", "0.3", "--facing"});
  EXPECT_EQ(facing.code, 3) << facing.err;
  EXPECT_THAT(facing.out,
              HasSubstr("distance to the closest of the faces that face the same way, within 90°"));
  EXPECT_THAT(facing.out, HasSubstr("-0.45"));
  const Json report = Json::parse(run("map", dent, {"--tolerance", "0.5", "--facing", "60", "--json"}).out);
  EXPECT_EQ(report["measured"]["kind"], "facing");
  EXPECT_EQ(report["measured"]["text"],
            "distance to the closest of the faces that face the same way, within 60°");
  EXPECT_EQ(report["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(report["tolerance"]["certified"], true);
  EXPECT_EQ(report["tolerance"]["text"], "every point of the surface is within ±0.5");
  EXPECT_EQ(report["tolerance"]["proof"]["faces_without_match"], 0);
  EXPECT_TRUE(report["error_bound"].is_null());
}

TEST_F(FacingJobs, ProveSymmetricTolerances) {
  const Outcome proven = run("map", dent, {"--tolerance", "0.5", "--facing"});
  EXPECT_EQ(proven.code, 0) << proven.err;
  EXPECT_THAT(proven.out, HasSubstr("PASS: every point of the surface is within ±0.5\n"));
  EXPECT_THAT(proven.out, HasSubstr("there, all but the verdict is an estimate"));
  const Outcome sided = run("map", dent, {"--tolerance=-0.5:0.1", "--facing"});
  EXPECT_EQ(sided.code, 0) << sided.err;
  EXPECT_THAT(sided.out, HasSubstr("within -0.5 to 0.1, an estimate for those between them"));
  EXPECT_THAT(sided.out, HasSubstr("there, all is an estimate"));
  const Json report = Json::parse(run("map", dent, {"--tolerance=-0.5:0.1", "--facing", "--json"}).out);
  EXPECT_EQ(report["tolerance"]["certified"], false);
  EXPECT_EQ(report["tolerance"]["proof"]["depends_on_signs"], true);
}

// A folded face of a scan, so small that no texel is on it: it has a sample of its own.
TEST_F(FacingJobs, FailOnAFaceWithoutATexel) {
  const std::string file = folder / "folded.obj";
  std::ofstream(file) << "v 0 0 0.25\nv 5 0 0.25\nv 0 5 0.25\nv 1 1 0.25\nv 1.0001 1 0.25\nv 1 1.0001 0.25\n"
                         "vt 0 0\nvt 1 0\nvt 0 1\nvt 0.2 0.2\nvt 0.20002 0.2\nvt 0.2 0.20002\n"
                         "f 1/1 2/2 3/3\nf 4/4 5/5 6/6\nf 4/4 6/6 5/5\n";
  const Outcome outcome = run("map", file, {"--tolerance", "0.1", "--facing", "--atlas", "uv"});
  EXPECT_EQ(outcome.code, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("FAIL: 4e-08 % of the area is out of ±0.1 (0 % above, 4e-08 % below)"));
  plate = write_obj(folder / "open.obj", square(10, 0.25));
  const Outcome open = run("map", file, {"--tolerance", "0.1", "--facing", "--atlas", "uv"});
  EXPECT_EQ(open.code, 3) << open.out << open.err;
  EXPECT_THAT(open.out, HasSubstr("FAIL: 4e-08 % of the area has no value, as no face of the reference faces "
                                  "as a point does"));
  const Json report =
      Json::parse(run("map", file, {"--tolerance", "0.1", "--facing", "--atlas", "uv", "--json"}).out);
  EXPECT_EQ(report["tolerance"]["reason"], "without match");
  EXPECT_EQ(report["without_match"], 1);
}

TEST_F(FacingJobs, BoundTheLargestDistance) {
  const auto hausdorff = [&](const std::string& o1, std::vector<std::string> more) {
    more.insert(more.begin(), {"hausdorff", o1, plate});
    return run_sdm(more);
  };
  EXPECT_EQ(hausdorff(dent, {"--tolerance", "0.3"}).code, 0);
  const Outcome facing = hausdorff(dent, {"--tolerance", "0.3", "--facing"});
  EXPECT_EQ(facing.code, 3) << facing.err;
  EXPECT_THAT(
      facing.out,
      HasSubstr("measured   distance to the closest of the faces that face the same way, within 90°"));
  EXPECT_THAT(facing.out, HasSubstr("hausdorff  0.45 "));
  const Json report = Json::parse(hausdorff(dent, {"--facing", "60", "--both", "--json"}).out);
  EXPECT_EQ(report["facing"], 60);
  EXPECT_NEAR(report["o1_to_o2"]["value"].get<double>(), 0.45, 1e-6);
  EXPECT_EQ(report["o1_to_o2"]["faces_without_match"], 0);
  EXPECT_EQ(report["o2_to_o1"]["faces_without_match"], 10);
  EXPECT_FALSE(Json::parse(hausdorff(dent, {"--json"}).out).contains("facing"));
  // The walls have no match, and so no distance.
  const Outcome both = hausdorff(dent, {"--facing", "--both", "--tolerance", "100"});
  EXPECT_EQ(both.code, 3) << both.err;
  EXPECT_THAT(both.out, HasSubstr("left out: 10 faces of O2"));
  EXPECT_THAT(both.out, HasSubstr("FAIL: faces without a match have no distance"));
  const std::string turned = write_obj(folder / "turned.obj", placed(square(1, 0), "rotate:45:0:0"));
  const Outcome none = hausdorff(turned, {"--facing", "10"});
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("faces the same way"));
  EXPECT_EQ(hausdorff(dent, {"--facing", "0"}).code, 2);
}

// Where the other skin is nearer than a defect is deep, the closest point says nothing.
TEST_F(FacingJobs, ThinWallsHaveANote) {
  const std::string note = "% of O2's walls are thinner than twice the tolerance, 0.6";
  const Outcome thin = run("map", dent, {"--tolerance", "0.3"});
  EXPECT_THAT(thin.out, HasSubstr(note));
  EXPECT_THAT(thin.out, HasSubstr("--facing"));
  const Json report = Json::parse(run("map", dent, {"--tolerance", "0.3", "--json"}).out);
  EXPECT_THAT(report["notes"].dump(), HasSubstr(note));
  EXPECT_THAT(run("points", cloud(false), {"--tolerance", "0.3"}).out, HasSubstr(note));
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--tolerance", "0.3", "--facing"},
                                             {"--tolerance", "0.3", "--along", "0,0,1"},
                                             {"--tolerance", "0.2"},
                                             {}})
    EXPECT_THAT(run("map", dent, more).out, Not(HasSubstr("thinner than")));
  plate = write_obj(folder / "block.obj", cube(10));
  EXPECT_THAT(run("map", dent, {"--tolerance", "0.6"}).out, Not(HasSubstr("thinner than")));
  plate = write_obj(folder / "open.obj", square(10, 0));
  EXPECT_THAT(run("map", dent, {"--tolerance", "0.6"}).out, Not(HasSubstr("thinner than")));
}

// A pit of 0.79 in a sheet of 1 is 0.21 from the other skin.
TEST_F(FacingJobs, DecideWhereWallsAreThin) {
  plate = write_obj(folder / "sheet.obj", sheet(0));
  const std::string pitted = write_obj(folder / "pitted.obj", sheet(0.79));
  const Outcome fails = run("map", pitted, {"--tolerance", "0.6"});
  EXPECT_EQ(fails.code, 3) << fails.out << fails.err;
  EXPECT_THAT(fails.out, HasSubstr("FAIL: a point is out of ±0.6 by the faces of the reference that face the "
                                   "same way, as its walls are thin: -0."));
  const Json report = Json::parse(run("map", pitted, {"--tolerance", "0.6", "--json"}).out);
  EXPECT_EQ(report["measured"]["kind"], "closest");
  EXPECT_EQ(report["tolerance"]["by_facing"], true);
  EXPECT_EQ(report["tolerance"]["certified"], true);
  EXPECT_EQ(report["tolerance"]["reason"], "exceeded");
  EXPECT_LT(report["tolerance"]["proof"]["witness"]["distance"], -0.6);
  EXPECT_DOUBLE_EQ(report["evidence"]["thin_walls"], 1);
  EXPECT_EQ(run("map", pitted, {"--tolerance", "0.8"}).code, 0);
  const std::string shallow = write_obj(folder / "shallow.obj", sheet(0.4));
  const Json thick = Json::parse(run("map", shallow, {"--tolerance", "0.49", "--json"}).out);
  EXPECT_EQ(thick["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(thick["tolerance"]["by_facing"], nullptr) << "no wall is as thin as twice that";
  const Json good = Json::parse(run("map", plate, {"--tolerance", "0.6", "--json"}).out);
  EXPECT_EQ(good["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(good["tolerance"]["certified"], true);
  EXPECT_EQ(good["tolerance"]["by_facing"], true);
  EXPECT_EQ(good["doubts"], Json::array());

  const std::string named = folder / "named.obj", table = folder / "table.csv";
  std::ofstream(named) << "o part\n" << contents(pitted);
  std::ofstream(table) << "group,lower,upper\npart,-0.6,0.6\n";
  EXPECT_EQ(run("map", named, {"--tolerance-table", table}).code, 3);
  EXPECT_EQ(run_sdm({"sequence", pitted, plate, "--tolerance", "0.6", "-o", out, "--resolution", "32"}).code,
            3);
}

TEST_F(FacingJobs, DoubtWhereWallsAreThinAndNothingDecides) {
  plate = write_obj(folder / "sheet.obj", sheet(0));
  // Limits that differ by sign, between which the pit is.
  const std::string pitted = write_obj(folder / "pitted.obj", sheet(0.58));
  const Outcome doubtful = run("map", pitted, {"--tolerance=-0.6:0.55"});
  EXPECT_EQ(doubtful.code, 5) << doubtful.out;
  EXPECT_THAT(doubtful.out,
              HasSubstr("DOUBTFUL: every point of the surface is within -0.6 to 0.55, but walls of "
                        "O2 are thinner than twice the tolerance"));
  EXPECT_EQ(run("map", pitted, {"--tolerance=-0.6:0.55", "--accept-doubts"}).code, 0);
  const Json report = Json::parse(run("map", pitted, {"--tolerance=-0.6:0.55", "--json"}).out);
  EXPECT_EQ(report["doubts"][0]["reason"], "thin walls");
  // A scan of the upper side that is inside out, and has no outside that would tell.
  Mesh scan = sheet(0);
  std::erase_if(scan.triangles, [](const Triangle& t) { return t[0] < 121 || t[1] < 121 || t[2] < 121; });
  EXPECT_EQ(run("map", write_obj(folder / "scan.obj", scan), {"--tolerance", "0.6"}).code, 0);
  for (Triangle& t : scan.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(run("map", write_obj(folder / "scan.obj", scan), {"--tolerance", "0.6"}).code, 5);

  plate = write_obj(folder / "plate.obj", flat(cube()));
  EXPECT_EQ(run("points", cloud(false), {"--tolerance", "0.3"}).code, 5);
  EXPECT_EQ(run("points", cloud(false), {"--tolerance", "0.3", "--accept-doubts"}).code, 0);
  const Outcome with = run("points", cloud(true), {"--tolerance", "0.3"});
  EXPECT_EQ(with.code, 3) << with.out;
  EXPECT_THAT(with.out, HasSubstr("by the faces of the reference that face the same way"));
  EXPECT_EQ(run("points", cloud(true), {"--tolerance", "0.5"}).code, 0);
}

TEST_F(FacingJobs, FailWithoutAMatch) {
  const std::string turned = write_obj(folder / "side.obj", placed(square(1, 0), "rotate:45:0:0"));
  const Outcome result = run("map", turned, {"--tolerance", "1", "--facing", "10"});
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_THAT(result.out, HasSubstr("no face that faces them"));
  EXPECT_THAT(
      result.out,
      HasSubstr("FAIL: 100 % of the area has no value, as no face of the reference faces as a point"));
}

TEST_F(FacingJobs, OfCloudsNeedNormals) {
  const Outcome without = run("points", cloud(false), {"--facing"});
  EXPECT_EQ(without.code, 1);
  EXPECT_THAT(without.err, HasSubstr("the cloud has no normals"));
  const Outcome with = run("points", cloud(true), {"--facing", "--tolerance", "0.3"});
  EXPECT_EQ(with.code, 3) << with.err;
  EXPECT_THAT(with.out, HasSubstr("distance to the closest of the faces that face the same way, within 90°"));
  EXPECT_THAT(with.out, HasSubstr("-0.45"));
}

TEST_F(FacingJobs, CloudsAreMeasuredAlongLines) {
  const Outcome without = run("points", cloud(false), {"--along", "normal"});
  EXPECT_EQ(without.code, 1);
  EXPECT_THAT(without.err, HasSubstr("the cloud has no normals to measure along; give a direction"));
  // 0.05 above the lower skin, which only points without normals may be measured to.
  const Outcome any = run("points", cloud(false), {"--along", "0,0,1", "--tolerance", "0.1"});
  EXPECT_EQ(any.code, 0) << any.err;
  EXPECT_THAT(any.out, HasSubstr("measured  distance along the direction (0 0 1), to both sides"));
  EXPECT_THAT(any.out, HasSubstr("min -0.05"));
  for (const std::string line : {"normal", "0,0,1"}) {
    const Outcome with = run("points", cloud(true), {"--along", line, "--tolerance", "0.3"});
    EXPECT_EQ(with.code, 3) << with.err;
    EXPECT_THAT(with.out, HasSubstr("min -0.45"));
  }
  const Json report = Json::parse(run("points", cloud(true), {"--along", "normal", "--json"}).out);
  EXPECT_EQ(report["measured"]["kind"], "along");
  EXPECT_EQ(report["measured"]["text"], "distance along the normal of the point, to both sides");
  EXPECT_EQ(report["sign"]["method"], "side");
  const Json beside = Json::parse(run("points", cloud(true), {"--along", "1,0,0", "--json"}).out);
  EXPECT_EQ(beside["without_match"], 8) << "at a right angle to the normals";
  EXPECT_EQ(run("points", cloud(true), {"--along", "normal", "--facing"}).code, 2);
  EXPECT_EQ(run("points", cloud(true), {"--along", "normal", "--sign", "none"}).code, 2);
}

TEST_F(FacingJobs, RefuseOtherSignsAndAngles) {
  EXPECT_EQ(run("map", dent, {"--facing", "--sign", "exact"}).code, 2);
  EXPECT_EQ(run("map", dent, {"--facing", "0"}).code, 2);
  EXPECT_EQ(run("map", dent, {"--facing", "181"}).code, 2);
  const Outcome bounded = run_sdm({"map", dent, plate, "-o", out, "--facing", "--precision", "0.1"});
  EXPECT_EQ(bounded.code, 2);
  EXPECT_THAT(bounded.err,
              HasSubstr("--precision excludes --facing: nothing bounds such distances between samples"));
  EXPECT_THAT(run_sdm({"map", "--help"}).out, HasSubstr("--facing [ANGLE]"));
}

TEST_F(FacingJobs, SideGivesOpenReferencesSigns) {
  plate = write_obj(folder / "open.obj", square(10, 0));
  const Json report = Json::parse(run("map", dent, {"--sign", "side", "--json"}).out);
  EXPECT_EQ(report["sign"]["method"], "side");
  EXPECT_NEAR(report["distance"]["max"].get<double>(), -0.2, 1e-6);
  EXPECT_THAT(run("map", dent, {"--sign", "side"}).out,
              HasSubstr("signs are estimates (0 texels and 0 vertices at the boundary of O2"));
  const std::string wide = write_obj(folder / "wide.obj", square(11, -0.2));
  const Outcome beside = run("map", wide, {"--sign", "side", "--tolerance", "-1:0.1"});
  EXPECT_EQ(beside.code, 4) << beside.out;
  EXPECT_THAT(beside.out, HasSubstr("and 4 vertices at the boundary"));
}

}  // namespace
}  // namespace sdm::test
