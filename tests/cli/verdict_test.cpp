// Verdicts of whole jobs: units that were mistaken, doubts, and what overrules them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/samples.h"
#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// A part, and a scan of it that is tilted and shifted.
struct Verdicts : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out";

  /// The scan in another unit.
  [[nodiscard]] std::string scan_of(const Mesh& part, double factor) const {
    const double size = diagonal(bounds(part));
    return write_obj(folder / "scan.obj", placed(part, fmt::format("rotate:1:-1:1,translate:{}:0:0,scale:{}",
                                                                   0.01 * size, factor)));
  }
  [[nodiscard]] Outcome map(const std::string& o1, const std::string& o2,
                            const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"map", o1, o2, "-o", out, "--write", "none", "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

const std::vector<std::pair<double, std::string>> kUnits{
    {10, "cm"}, {25.4, "in"}, {304.8, "ft"}, {1000, "m"}};

struct UnitMistakes : Verdicts, ::testing::WithParamInterface<const char*> {};

// Of each part in 4 units, in both directions.
TEST_P(UnitMistakes, AreWithheld) {
  const Mesh part = load(GetParam(), "fit,scale:100");
  const std::string o2 = write_obj(folder / "part.obj", part);
  for (const auto& [factor, unit] : kUnits) {
    SCOPED_TRACE(unit);
    const std::string small = scan_of(part, 1 / factor);
    const Outcome withheld = map(small, o2, {"--align", "--tolerance", "30"});
    EXPECT_EQ(withheld.code, 5) << withheld.out << withheld.err;
    EXPECT_THAT(withheld.out, HasSubstr("tolerance DOUBTFUL: every point of the surface is within"));
    EXPECT_THAT(withheld.out, HasSubstr(fmt::format("--transform-o1 scale:{},", factor)));
    const Outcome mended =
        map(small, o2, {"--align", "--tolerance", "1", "--units-o1", unit, "--units-o2", "mm"});
    EXPECT_EQ(mended.code, 0) << mended.out << mended.err;
    const Outcome large = map(scan_of(part, factor), o2, {"--align", "--tolerance", "30"});
    EXPECT_TRUE(large.code == 3 || large.code == 5) << large.out << large.err;
  }
}

// The remedy, done: the same verdict as if there had been no mistake. --units is not what the doubt guesses.
TEST_P(UnitMistakes, AreMendedByTheRemedyThatIsPrinted) {
  const Mesh part = load(GetParam(), "fit,scale:100");
  const std::string o2 = write_obj(folder / "part.obj", part);
  const std::vector<std::string> options{"--align", "--units", "cm", "--tolerance", "1", "--json"};
  const Mesh defective = joined(part, moved(cube(1.2), part.positions[0]));
  for (const auto& [scan, verdict] : {std::pair(&part, 0), std::pair(&defective, 3)})
    for (const auto& [factor, unit] : kUnits) {
      SCOPED_TRACE(fmt::format("{}, code {}", unit, verdict));
      const std::string small = scan_of(*scan, 1 / factor);
      const Outcome mistaken = map(small, o2, options);
      EXPECT_TRUE(mistaken.code == 3 || mistaken.code == 5) << mistaken.out << mistaken.err;
      const Json doubts = Json::parse(mistaken.out)["doubts"];
      ASSERT_FALSE(doubts.empty());
      const std::string remedy = doubts[0]["remedy"];
      std::vector<std::string> mended = options;
      mended.emplace_back("--transform-o1");
      mended.push_back(remedy.substr(remedy.find("scale:"), remedy.find(',') - remedy.find("scale:")));
      const Outcome again = map(small, o2, mended);
      EXPECT_EQ(again.code, verdict) << remedy << again.out << again.err;
      EXPECT_EQ(Json::parse(again.out)["o2"]["transform"], "");
    }
}

INSTANTIATE_TEST_SUITE_P(Parts, UnitMistakes, ::testing::Values("fandisk.off", "cow.off", "elephant.off"));

TEST_F(Verdicts, TheSamePartInTheSameUnitIsNotDoubted) {
  for (const char* name : {"fandisk.off", "cow.off", "elephant.off", "anchor.off", "pinion.off"}) {
    const Mesh part = load(name, "fit,scale:100");
    const std::string o2 = write_obj(folder / "part.obj", part);
    const Outcome run = map(scan_of(part, 1), o2, {"--align", "--tolerance", "1"});
    EXPECT_EQ(run.code, 0) << name << run.out << run.err;
    EXPECT_THAT(run.out, Not(HasSubstr("doubt")));
  }
}

// Without an alignment, the scan lies in one corner of the part, within the tolerance.
TEST_F(Verdicts, AUnitIsMistakenInPlaceToo) {
  const Mesh part = placed(cube(0.5), "translate:0.5:0.5:0.5,scale:100");
  const std::string o1 = folder / "scan.ply", o2 = write_obj(folder / "part.obj", part);
  for (const auto& [factor, unit] : kUnits) {
    SCOPED_TRACE(unit);
    write_mesh(o1, placed(part, fmt::format("scale:{}", 1 / factor)));
    for (const char* command : {"map", "points"}) {
      SCOPED_TRACE(command);
      std::vector<std::string> arguments{command, o1, o2, "-o", out, "--tolerance", "12"};
      const Outcome withheld = run_sdm(arguments);
      EXPECT_EQ(withheld.code, 5) << withheld.out << withheld.err;
      EXPECT_THAT(
          withheld.out,
          HasSubstr(fmt::format("O1 has the size and the place of O2 if it is {} times as large", factor)));
      arguments.insert(arguments.end(), {"--transform-o1", fmt::format("scale:{}", factor)});
      EXPECT_EQ(run_sdm(arguments).code, 0);
    }
    EXPECT_EQ(map(o1, o2, {"--tolerance", "12", "--accept-doubts"}).code, 0);
  }
}

// As of a map, in each frame: the part moves into the place where its unit is mistaken, and loses a face
// there.
TEST_F(Verdicts, AUnitIsMistakenInASequenceToo) {
  Mesh part = placed(cube(0.5), "translate:0.5:0.5:0.5");
  for (Vec3& p : part.positions) p = {40 * p[0], 60 * p[1], 20 * p[2]};
  const Mesh scan = placed(part, "scale:0.001");
  const std::string o2 = write_obj(folder / "part.obj", part);
  const std::string frames = (std::filesystem::create_directory(folder / "scan"), folder / "scan");
  write_obj(std::filesystem::path(frames) / "0.obj", part);
  Mesh open = scan;
  open.triangles.pop_back();
  write_obj(std::filesystem::path(frames) / "1.obj", open);
  const auto run = [&](const std::string& o1, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"sequence",     o1,  o2, "-o", out, "--tolerance", "0.1",
                                       "--resolution", "32"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  };
  const std::string still = write_obj(folder / "scan.obj", scan);
  const Outcome withheld = run(still, {"--both", "--json"});
  EXPECT_EQ(withheld.code, 3) << "O2 is farther from O1 than O1 from O2" << withheld.err;
  const Outcome doubtful = run(still, {"--player"});
  EXPECT_EQ(doubtful.code, 5) << doubtful.err;
  EXPECT_THAT(doubtful.out, HasSubstr("DOUBTFUL: " + still));
  EXPECT_THAT(doubtful.out, HasSubstr("tolerance  O1: DOUBTFUL in 1 of 1 frames\n"));
  EXPECT_THAT(doubtful.out, HasSubstr("the size and the place of O2 if it is 1000 times as large"));
  EXPECT_THAT(contents(out + "/player.html"), HasSubstr("1000 times as large"));
  const Json line = Json::parse(contents(out + "/frames.jsonl"));
  EXPECT_EQ(line["distance"]["o1"]["verdict"], "DOUBTFUL");
  EXPECT_EQ(line["doubts"][0]["reason"], "other unit");
  EXPECT_EQ(run(still, {"--accept-doubts"}).code, 0);
  EXPECT_EQ(Json::parse(contents(out + "/frames.jsonl"))["doubts"], line["doubts"]);

  EXPECT_EQ(run(frames, {"--allow-topology"}).code, 5);
  std::istringstream lines(contents(out + "/frames.jsonl"));
  for (const std::size_t doubts : {0u, 1u}) {
    std::string text;
    std::getline(lines, text);
    EXPECT_EQ(Json::parse(text)["doubts"].size(), doubts) << text;
  }
}

// A small region of a part, near its origin, is not a part in another unit.
TEST_F(Verdicts, APartialScanInPlaceIsNotDoubted) {
  const Mesh part = load("fandisk.off", "fit,scale:100");
  const std::string o2 = write_obj(folder / "part.obj", part);
  for (const double radius : {5.0, 8.0, 12.0}) {
    Mesh scan = part;
    const Vec3 middle = part.positions[part.triangles[0][0]];
    std::erase_if(scan.triangles,
                  [&](const Triangle& t) { return norm(part.positions[t[0]] - middle) > radius; });
    const Outcome run = map(write_obj(folder / "scan.obj", scan), o2, {"--tolerance", "1"});
    EXPECT_EQ(run.code, 0) << radius << run.out << run.err;
  }
}

TEST_F(Verdicts, DoubtsAreReportedAndOverruled) {
  const Mesh part = load("fandisk.off", "fit,scale:100");
  const std::string o2 = write_obj(folder / "part.obj", part), o1 = scan_of(part, 0.001);
  const std::vector<std::string> options{"--align", "--tolerance", "30", "--json"};
  const Outcome run = map(o1, o2, options);
  EXPECT_EQ(run.code, 5);
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["tolerance"]["verdict"], "DOUBTFUL");
  EXPECT_EQ(report["tolerance"]["reason"], "in doubt");
  EXPECT_EQ(report["doubts"][0]["reason"], "other unit");
  EXPECT_THAT(report["tolerance"]["text"].get<std::string>(),
              HasSubstr(report["doubts"][0]["text"].get<std::string>()));
  std::vector<std::string> accepting = options;
  accepting.emplace_back("--accept-doubts");
  const Outcome accepted = map(o1, o2, accepting);
  EXPECT_EQ(accepted.code, 0) << accepted.err;
  EXPECT_EQ(Json::parse(accepted.out)["tolerance"]["verdict"], "PASS");
  EXPECT_EQ(Json::parse(accepted.out)["doubts"], report["doubts"]);
}

TEST_F(Verdicts, AFailureStaysOne) {
  const Mesh part = load("fandisk.off", "fit,scale:100");
  const std::string o2 = write_obj(folder / "part.obj", part);
  const Outcome run = map(scan_of(part, 0.001), o2, {"--align", "--tolerance", "1:2"});
  EXPECT_EQ(run.code, 3) << run.out;
  EXPECT_THAT(run.out, HasSubstr("doubt     O1 fits O2 far better 1000 times as large"));
}

// A plane slides and turns in itself.
TEST_F(Verdicts, AnUndeterminedAlignmentIsDoubted) {
  const std::string o1 = write_obj(folder / "o1.obj", square(1, 0.01)),
                    o2 = write_obj(folder / "o2.obj", square(2, 0));
  const Outcome run = map(o1, o2, {"--align", "--tolerance", "0.1"});
  EXPECT_EQ(run.code, 5) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("do not determine 3 freedoms of the alignment"));
  EXPECT_EQ(map(o1, o2, {"--tolerance", "0.1"}).code, 0) << "without an alignment there is no doubt";
}

// Half of the square is covered, and 0.1 around it.
TEST_F(Verdicts, CoverageIsMeasuredAndDoubted) {
  Mesh half = square(2, 0);
  for (Vec3& p : half.positions) p[0] = 0.5 * p[0] - 0.5;
  const std::string o1 = write_obj(folder / "o1.obj", half), o2 = write_obj(folder / "o2.obj", square(2, 0));
  const auto covered = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--tolerance", "0.1", "--json"};
    options.insert(options.end(), more.begin(), more.end());
    return map(o1, o2, options);
  };
  const Outcome measured = covered({"--min-coverage", "0"});
  EXPECT_EQ(measured.code, 0) << measured.err;
  const Json coverage = Json::parse(measured.out)["coverage"];
  EXPECT_NEAR(coverage["value"], 0.55, 0.01);
  EXPECT_LE(coverage["lower"], 0.55);
  EXPECT_GE(coverage["upper"], 0.55);
  EXPECT_LT(coverage["upper"].get<double>() - coverage["lower"].get<double>(), 0.02);
  EXPECT_EQ(coverage["reach"], 0.1);
  EXPECT_EQ(covered({"--min-coverage", "0.5"}).code, 0);
  EXPECT_EQ(covered({"--min-coverage", "0.6"}).code, 5);
  EXPECT_EQ(covered({"--min-coverage", "0.6", "--reach", "0.3"}).code, 0);
  EXPECT_EQ(covered({"--min-coverage", "0.6", "--accept-doubts"}).code, 0);
  EXPECT_EQ(covered({"--reach", "0.3"}).code, 2);
  EXPECT_EQ(map(o1, o2, {"--min-coverage", "0.6"}).code, 2);

  // As a cloud.
  std::ofstream cloud(folder / "cloud.xyz");
  for (int i = 0; i <= 50; ++i)
    for (int j = 0; j <= 100; ++j) cloud << -1 + 0.02 * i << ' ' << -1 + 0.02 * j << " 0\n";
  cloud.close();
  const Outcome points = run_sdm({"points", folder / "cloud.xyz", o2, "-o", out, "--write", "none",
                                  "--tolerance", "0.1", "--min-coverage", "0.6", "--json"});
  EXPECT_EQ(points.code, 5) << points.err;
  const Json report = Json::parse(points.out);
  EXPECT_NEAR(report["coverage"]["value"], 0.55, 0.01);
  EXPECT_EQ(report["doubts"][0]["reason"], "low coverage");
}

TEST_F(Verdicts, FilesInTheirUnits) {
  const std::string o2 = write_obj(folder / "part.obj", cube(1)),
                    o1 = write_obj(folder / "scan.obj", cube(0.001));
  const std::vector<std::string> tolerance{"--tolerance", "1e-9", "--json"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.end(), tolerance.begin(), tolerance.end());
    return map(o1, o2, more);
  };
  const Outcome converted = run({"--units-o1", "m", "--units-o2", "mm"});
  EXPECT_EQ(converted.code, 0) << converted.err;
  EXPECT_EQ(Json::parse(converted.out)["units"], "mm");
  EXPECT_EQ(Json::parse(converted.out)["o1"]["transform"], "scale:1000");
  EXPECT_EQ(run({"--units", "mm", "--units-o1", "m"}).code, 0) << "O2 is in the unit of all lengths";
  EXPECT_EQ(Json::parse(run({"--units", "in", "--units-o1", "m", "--units-o2", "mm"}).out)["units"], "in");
  EXPECT_EQ(run({"--units-o1", "m"}).code, 2);
  EXPECT_EQ(run({"--units-o1", "parsec", "--units-o2", "mm"}).code, 2);
  EXPECT_EQ(run({"--units", "parsec", "--units-o1", "m", "--units-o2", "mm"}).code, 2);
  EXPECT_EQ(run({}).code, 3);
}

// A part against itself, in any order of vertices, however coarse the map is.
TEST_F(Verdicts, APartAgainstItselfPasses) {
  for (const char* name : {"fandisk.off", "cow.off"}) {
    const std::string part = mesh_file(name);
    const Outcome run = map(part, part, {"--tolerance", "0.001"});
    EXPECT_EQ(run.code, 0) << run.out;
    EXPECT_THAT(run.out, HasSubstr("tolerance PASS: every point of the surface is within ±0.001\n"));
  }
}

// What is left open is within the accuracy, and has an exit code.
TEST_F(Verdicts, NotDecidedSaysByHowMuch) {
  const std::string o1 = write_obj(folder / "o1.obj", square(1, 0.1)),
                    o2 = write_obj(folder / "o2.obj", square(2, 0));
  const Outcome open = map(o1, o2, {"--tolerance", "0.0999999"});
  EXPECT_EQ(open.code, 4) << open.out;
  EXPECT_THAT(open.out, HasSubstr("NOT DECIDED: no point is out of 0.1 by more than "));
  EXPECT_THAT(open.out, Not(HasSubstr("--precision")));
  EXPECT_EQ(map(o1, o2, {"--tolerance", "0:0.2"}).code, 0);
  EXPECT_EQ(map(o2, o2, {"--tolerance", "0:0.2"}).code, 0) << "unsigned distances are not negative";
}

// Two parallel squares: the distance is known, and with it the verdict by each rule.
TEST_F(Verdicts, KeepTheUncertaintyAwayFromTheLimits) {
  const std::string o1 = write_obj(folder / "o1.obj", square(1, 0));
  write_mesh(folder / "cloud.ply", square(1, 0));
  for (const double d : {0.3, 0.8, 0.95, 1.05, 1.2, 3.0}) {
    const std::string o2 = write_obj(folder / "o2.obj", square(2, d));
    for (const double uncertainty : {0.0, 0.02, 0.1, 0.25}) {
      SCOPED_TRACE(fmt::format("{} ± {}", d, uncertainty));
      const std::string verdict = d < 1 - uncertainty ? "PASS" : d > 1 + uncertainty ? "FAIL" : "NOT DECIDED";
      const std::vector<std::string> judged{
          "--tolerance", "1", "--uncertainty", fmt::format("{}", uncertainty), "--accept-doubts", "--json"};
      for (const std::vector<std::string>& measured :
           {std::vector<std::string>{"map", o1, o2, "-o", out, "--write", "none", "--resolution", "16"},
            {"points", folder / "cloud.ply", o2, "-o", out},
            {"hausdorff", o1, o2}}) {
        SCOPED_TRACE(measured[0]);
        std::vector<std::string> arguments = measured;
        arguments.insert(arguments.end(), judged.begin(), judged.end());
        const Outcome run = run_sdm(arguments);
        const Json report = Json::parse(run.out, nullptr, false), &tolerance = report["tolerance"];
        ASSERT_TRUE(tolerance.is_object()) << run.err;
        EXPECT_EQ(tolerance["verdict"], verdict);
        EXPECT_EQ(run.code, verdict == "PASS" ? 0 : verdict == "FAIL" ? 3 : 4);
        EXPECT_EQ(tolerance["decision_rule"], uncertainty > 0 ? "ISO 14253-1" : "simple acceptance");
        const Json& evidence = measured[0] == "hausdorff" ? tolerance : report["evidence"];
        EXPECT_EQ(evidence["uncertainty"], uncertainty);
        EXPECT_EQ(evidence["guard"], uncertainty);
      }
    }
  }
}

TEST_F(Verdicts, OfWallsKeepTheUncertaintyAwayToo) {
  const std::string part = write_obj(folder / "part.obj", cube(1));  // walls of 2
  for (const auto& [least, uncertainty, code] : {std::tuple("1.95", "0", 0),
                                                 {"1.95", "0.04", 0},
                                                 {"1.95", "0.06", 4},
                                                 {"2.05", "0.06", 4},
                                                 {"2.05", "0.04", 3}})
    EXPECT_EQ(run_sdm({"thickness", part, "-o", out, "--write", "none", "--resolution", "16", "--min", least,
                       "--uncertainty", uncertainty})
                  .code,
              code)
        << least << " ± " << uncertainty;
}

TEST_F(Verdicts, StateTheUncertainty) {
  const std::string o1 = write_obj(folder / "o1.obj", square(1, 0)),
                    o2 = write_obj(folder / "o2.obj", square(2, 0.5));
  const auto text = [&](const char* tolerance) {
    return map(o1, o2, {"--tolerance", tolerance, "--uncertainty", "0.02", "--units", "mm"}).out;
  };
  EXPECT_THAT(text("1"), HasSubstr("PASS: every point of the surface is within 1 mm, by more than the "
                                   "uncertainty, 0.02 mm (ISO 14253-1)"));
  EXPECT_THAT(text("0.4"),
              HasSubstr("FAIL: 100 % of the area is out of 0.4 mm by more than the uncertainty, 0.02 mm "
                        "(ISO 14253-1)"));
  EXPECT_THAT(text("0.51"),
              HasSubstr("NOT DECIDED: all points are within 0.51 mm or out of it by less than "
                        "the guard band, 0.02 mm, which is the uncertainty (ISO 14253-1); one is "
                        "closer to a limit than that"));
  const Outcome nothing = map(o1, o2, {"--uncertainty", "0.02"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("--uncertainty: needs limits"));
  EXPECT_EQ(map(o1, o2, {"--tolerance", "1", "--uncertainty", "-0.1"}).code, 2);
}

}  // namespace
}  // namespace sdm::test
