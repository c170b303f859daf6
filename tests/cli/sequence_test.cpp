// `sdm sequence`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/proximity_query.h>
#include <sdm/sampling_bound.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "cli/samples.h"
#include "io_write/read_png.h"
#include "support/oracle.h"
#include "support/run_sdm.h"
#include "support/same_contents.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

/// The first torus passes the second one in twelve frames.
struct SequenceCommand : ::testing::Test, TwoTori {
  std::string moving = folder / "moving";

  SequenceCommand() {
    std::filesystem::create_directory(moving);
    for (int i = 0; i < 12; ++i) write_frame(i, ring(12, 1, {0.5 * i - 3.2, 0, 0}));
  }
  void write_frame(int i, const Mesh& mesh) const {
    write_obj(std::filesystem::path(moving) / (std::to_string(i) + ".obj"), mesh);
  }
  [[nodiscard]] std::vector<std::string> sequence(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"sequence", moving, o2, "-o", out, "--resolution", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] std::vector<Json> lines() const {
    std::istringstream text(contents(out + "/frames.jsonl"));
    std::vector<Json> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
    return lines;
  }
  [[nodiscard]] std::size_t csv_rows() const {
    const std::string text = contents(out + "/frames.csv");
    return static_cast<std::size_t>(std::ranges::count(text, '\n')) - 1;
  }
};

TEST_F(SequenceCommand, FollowsTheBodies) {
  const Outcome run = run_sdm(sequence({"--maps", "5"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"frames.csv", "frames.jsonl", "maps", "max.png",
                                                     "mean.png", "min.png", "plot.png", "temporal.exr"}));
  EXPECT_EQ(names_in(out + "/maps"), (std::vector<std::string>{"0000.exr", "0000.png", "0005.exr", "0005.png",
                                                               "0010.exr", "0010.png"}));
  const std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), 12u);
  EXPECT_EQ(csv_rows(), 12u);
  const AtlasOptions atlas{.resolution = 64};
  ProximityQuery query(Shape(ring(12, 1, {-3.2, 0, 0}), atlas), Shape(read_mesh(o2), atlas));
  SamplingBound bound(query.surface(0));
  const RelativeError error(query.surface(0), bound);
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(all[i]["frame"], i);
    query.refit(read_mesh(std::filesystem::path(moving) / (std::to_string(i) + ".obj")).positions, {});
    EXPECT_EQ(all[i]["separation"]["value"], query.separation().value);
    EXPECT_EQ(all[i]["colliding"]["value"], query.colliding());
    EXPECT_EQ(all[i]["penetration_depth"]["value"], query.penetration_depth()->value);
    EXPECT_EQ(all[i]["contacts"], query.contacts().size());
    bound.refit(query.surface(0));
    EXPECT_EQ(all[i]["error_bound"]["o1"], bound.value());
    EXPECT_EQ(all[i]["relative_error"]["o1"], error.of(bound));
    EXPECT_GT(all[i]["time_ms"]["total"], 0);
  }
  EXPECT_GT(all[6]["penetration_depth"]["value"], 0.1);
  EXPECT_THAT(run.out, HasSubstr("frames     12"));
  EXPECT_THAT(run.out, ::testing::StartsWith(moving)) << "no verdict without a tolerance";
}

TEST_F(SequenceCommand, MeasuresBothBodies) {
  const Outcome run =
      run_sdm({"sequence", moving, o2, "-o", out, "--resolution", "256", "--atlas", "triangles", "--both",
               "--maps", "5", "--tolerance", "3", "--colormap", "viridis"});
  ASSERT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.out, ::testing::StartsWith("FAIL: " + moving));
  EXPECT_THAT(run.out, HasSubstr("tolerance  O1: FAIL in "));
  EXPECT_EQ(names_in(out + "/maps").size(), 12u);
  EXPECT_TRUE(std::filesystem::exists(out + "/maps/0005_o2.exr"));
  const std::vector<Json> all = lines();
  bool fails = false;
  for (const Json& line : all) {
    for (const char* body : {"o1", "o2"}) {
      const Json& distance = line["distance"][body];
      EXPECT_LE(distance["min"], distance["mean"]);
      EXPECT_LE(distance["mean"], distance["max"]);
      const double largest =
          std::max(std::abs(distance["min"].get<double>()), std::abs(distance["max"].get<double>()));
      EXPECT_EQ(distance["verdict"] == "FAIL", largest > 3);
      EXPECT_EQ(distance["exceeded_area_fraction"] > 0, largest > 3);
      fails |= largest > 3;
    }
    // Apart from each other, the nearest points of both are at the separation.
    if (const double separation = line["separation"]["value"]; separation > 0) {
      EXPECT_GE(line["distance"]["o1"]["min"], separation - 1e-6);
      EXPECT_NEAR(line["distance"]["o2"]["min"], separation, 0.2);
    }
  }
  EXPECT_TRUE(fails);
  const std::string csv = contents(out + "/frames.csv");
  EXPECT_THAT(csv, HasSubstr(",distance_max_o2,verdict_o2,read_ms,"));
  EXPECT_THAT(csv, HasSubstr(",FAIL,"));
  EXPECT_EQ(run_sdm(sequence({"--tolerance", "100"})).code, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/maps/0005_o2.exr")) << "of the earlier run";
  EXPECT_EQ(run_sdm(sequence({"--range", "2", "1"})).code, 2);
}

// The legends of all maps are the same picture.
TEST_F(SequenceCommand, FramesShareAScale) {
  ASSERT_EQ(run_sdm(sequence({"--maps", "3", "--no-temporal"})).code, 0);
  std::vector<std::vector<Rgb>> bars;
  for (const char* name : {"0000", "0003", "0009"}) {
    const Pixels pixels = read_png(out + "/maps/" + name + ".png");
    std::vector<Rgb>& bar = bars.emplace_back();
    for (std::uint32_t y = 0; y < pixels.height * 6 / 10; ++y)
      for (std::uint32_t x = 64; x < pixels.width; ++x) bar.push_back(pixels.at(x, y));
  }
  EXPECT_EQ(bars[0], bars[1]);
  EXPECT_EQ(bars[0], bars[2]);
}

TEST_F(SequenceCommand, PrintsLinesAsJson) {
  const Outcome run = run_sdm(sequence({"--json", "--no-temporal"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, contents(out + "/frames.jsonl"));
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"frames.csv", "frames.jsonl", "plot.png"}));
}

// Completed frames are kept, and the message mentions them.
TEST_F(SequenceCommand, StopsAtABadFrame) {
  std::filesystem::remove(moving + "/4.obj");
  Outcome run = run_sdm(sequence());
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("frame 4"));
  EXPECT_THAT(run.err, HasSubstr("4 earlier frames are in " + out));
  std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), 5u);
  EXPECT_THAT(all[4]["error"].get<std::string>(), HasSubstr("frame 4"));
  EXPECT_EQ(csv_rows(), 4u);

  write_frame(4, ring(10));  // another mesh
  write_obj(std::filesystem::path(moving) / "7.obj", ring(12, 1, {std::nan(""), 0, 0}));
  run = run_sdm(sequence({"--keep-going"}));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("frames     10, and 2 that could not be used"));
  all = lines();
  ASSERT_EQ(all.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(all[i].contains("error"), i == 4 || i == 7) << i;
  EXPECT_EQ(csv_rows(), 10u);
}

TEST_F(SequenceCommand, PlacesAllFramesAsTheFirst) {
  const Outcome run =
      run_sdm(sequence({"--json", "--no-temporal", "--transform-o1", "scale:2,fit,translate:5:0:0"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const std::vector<Json> all = lines();
  // The torus moves by 0.5 a frame; fitted, its width is 1.
  const Box box = inspect(ring(12)).bounds;
  const double first = all[0]["separation"]["value"], last = all[11]["separation"]["value"];
  EXPECT_NEAR(last - first, 11 * 0.5 / (box.upper[0] - box.lower[0]), 0.1);
}

TEST_F(SequenceCommand, RefusesSequencesThatDoNotFit) {
  const std::string other = folder / "other";
  std::filesystem::create_directory(other);
  for (int i = 0; i < 3; ++i)
    write_obj(std::filesystem::path(other) / (std::to_string(i) + ".obj"), ring(12));
  const Outcome run = run_sdm({"sequence", moving, other, "-o", out});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("12 frames and"));
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(run_sdm({"sequence", moving, o2}).code, 2);
  EXPECT_THAT(run_sdm({"sequence", moving, o2, "-o", ""}).err, HasSubstr("the name of the folder is empty"));
  EXPECT_EQ(run_sdm(sequence({"--maps", "0"})).code, 2);
}

// Regression: pictures of an earlier run remained beside the new results.
TEST_F(SequenceCommand, ReplacesAllFilesOfAnEarlierRun) {
  ASSERT_EQ(run_sdm(sequence({"--maps", "5"})).code, 0);
  ASSERT_EQ(run_sdm(sequence({"--no-temporal"})).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"frames.csv", "frames.jsonl", "plot.png"}));
}

// And true: no point of the surface is farther from its nearest sample.
TEST_F(SequenceCommand, KeepsTheErrorBoundBelowAPrecision) {
  constexpr double kPrecision = 0.1;
  std::vector<Mesh> meshes;
  for (int i = 0; i < 12; ++i) {  // stretched up to three times, while it moves fast
    meshes.push_back(ring(12, 1, {0, 0, 0}));
    for (Vec3& p : meshes.back().positions) p = {p[0] + 2 * i, p[1] * (1 + 2 * std::sin(i * 0.3)), p[2]};
    write_frame(i, meshes.back());
  }
  const Outcome run = run_sdm(sequence({"--map-precision", "0.1", "--maps", "5"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("  map error  at most "));
  const std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), 12u);
  Surface surface(meshes[0], {.resolution = all[0]["resolution"]});
  SamplingBound bound(surface);
  EXPECT_LT(bound.value(), kPrecision / 2) << "the first frame alone would need less";
  double largest = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i]["resolution"], surface.resolution()) << "one resolution for all frames";
    EXPECT_FALSE(all[i].contains("topology"));
    const double reported = all[i]["error_bound"]["o1"];
    largest = std::max(largest, reported);
    EXPECT_LE(reported, kPrecision);
    surface.refit(meshes[i].positions);
    bound.refit(surface);
    EXPECT_LE(reported, bound.value());
    const oracle::CgalPoints samples(surface.sample_points());
    std::mt19937 random(1);
    for (const Triangle& t : meshes[i].triangles) {
      const double a = std::uniform_real_distribution<>(0, 1)(random), b = a / 2;
      Vec3 p;
      for (int k = 0; k < 3; ++k)
        p[k] = (1 - a) * meshes[i].positions[t[0]][k] + (a - b) * meshes[i].positions[t[1]][k] +
               b * meshes[i].positions[t[2]][k];
      EXPECT_LE(samples.distance(p), reported);
    }
  }
  EXPECT_GT(largest, 0.7 * kPrecision) << "finer than needed";
}

TEST_F(SequenceCommand, RefusesAPrecisionThatNoAtlasHas) {
  const Outcome run = run_sdm(sequence({"--map-precision", "1e-9"}));
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(run_sdm(sequence({"--map-precision", "0"})).code, 2);
}

/// The first torus passes the second one four times, stretched more and more: some results depend on shapes
/// and places of earlier frames.
struct Resume : SequenceCommand {
  static constexpr int kFrames = 48;
  std::string whole = folder / "whole";

  Resume() {
    for (int i = 0; i < kFrames; ++i) write_frame(i, shape(i));
  }
  static Mesh shape(int i) {
    Mesh mesh = ring(12, 1, {0.5 * (i % 12) - 3.2, 0, 0});
    for (Vec3& p : mesh.positions) p[2] *= 1 + 0.2 * (i % 12) * std::abs(p[1]);
    return mesh;
  }
  [[nodiscard]] std::vector<std::string> into(const std::string& to,
                                              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"sequence",     moving, o2,       "-o",     to,
                                       "--resolution", "128",  "--json", "--maps", "7"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// The number of frames that were kept.
  std::size_t interrupt(const std::vector<std::string>& more = {}, int after_lines = 5,
                        int signal = SIGINT) const {
    Outcome run = interrupted(more, after_lines, signal);
    // On a busy machine, the signal may come after the last frame.
    for (int again = 0; run.code == 0 && again < 5 && std::ranges::count(more, "--resume") == 0; ++again) {
      std::filesystem::remove_all(out);
      run = interrupted(more, after_lines, signal);
    }
    EXPECT_EQ(run.code, 128 + signal) << run.err;
    const std::size_t kept = lines().size();
    EXPECT_GE(kept, static_cast<std::size_t>(after_lines));
    EXPECT_LT(kept, std::size_t{kFrames}) << "finished before the interrupt";
    EXPECT_EQ(run.err, "sdm: error: interrupted; " + std::to_string(kept) + " of 48 frames are in " + out +
                           " (--resume continues)\n");
    EXPECT_EQ(run.out, contents(out + "/frames.jsonl"));
    return kept;
  }
  /// Times apart, the files are those of a run that was not interrupted.
  void expect_whole(const std::vector<std::string>& more = {}) const {
    ASSERT_EQ(run_sdm(into(whole, more)).code, 0);
    EXPECT_EQ(names_in(out), names_in(whole));
    EXPECT_EQ(names_in(out + "/maps"), names_in(whole + "/maps"));
    EXPECT_EQ(without_times(out), without_times(whole));
    EXPECT_EQ(columns(out), columns(whole));
    for (const std::string& name : names_in(whole))
      if (name != "maps" && !name.starts_with("frames") && name != "plot.png") {
        EXPECT_TRUE(same_contents(name, contents(out + "/" + name), contents(whole + "/" + name))) << name;
      }
    for (const std::string& name : names_in(whole + "/maps"))
      EXPECT_TRUE(same_contents(name, contents(out + "/maps/" + name), contents(whole + "/maps/" + name)))
          << name;
  }
  void expect_refusal(const std::vector<std::string>& arguments, const std::string& reason) const {
    const auto names = names_in(out);
    const std::string lines = contents(out + "/frames.jsonl");
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.err, HasSubstr("cannot resume in " + out + ": "));
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_EQ(names_in(out), names);
    EXPECT_EQ(contents(out + "/frames.jsonl"), lines);
  }

 private:
  [[nodiscard]] Outcome interrupted(const std::vector<std::string>& more, int after_lines, int signal) const {
    return run_sdm(into(out, more), {.interrupt_after_lines = after_lines, .signal = signal});
  }
  static std::string without_times(const std::string& in) {
    std::istringstream text(contents(in + "/frames.jsonl"));
    std::string result;
    for (std::string line; std::getline(text, line);)
      result += line.substr(0, line.find("\"time_ms\"")) + "\n";
    return result;
  }
  static std::vector<std::string> columns(const std::string& in) {
    std::istringstream text(contents(in + "/frames.csv"));
    std::vector<std::string> rows;
    for (std::string line; std::getline(text, line);) {
      std::size_t end = line.size();
      for (int times = 0; times < 7; ++times) end = line.rfind(',', end - 1);
      rows.push_back(line.substr(0, end));
    }
    return rows;
  }
};

TEST_F(Resume, AnInterruptKeepsFinishedFrames) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::size_t kept = interrupt({}, 5, signal);
    EXPECT_EQ(csv_rows(), kept);
    EXPECT_EQ(names_in(out),
              (std::vector<std::string>{"frames.csv", "frames.jsonl", "maps", "max.png", "mean.png",
                                        "min.png", "plot.png", "resume.state", "temporal.exr"}));
  }
}

TEST_F(Resume, EndsWithTheFilesOfAnUninterruptedRun) {
  const std::size_t first = interrupt();
  const std::size_t second = interrupt({"--resume"}, static_cast<int>(first) + 3);
  EXPECT_GT(second, first);
  const Outcome run = run_sdm(into(out, {"--resume"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, contents(out + "/frames.jsonl"));
  expect_whole();
}

TEST_F(Resume, WithAPlayerAndBothBodies) {
  if (!can_write_html()) GTEST_SKIP() << "built without pages";
  const std::vector<std::string> more{"--player", "--both"};
  interrupt(more);
  std::vector<std::string> again = more;
  again.emplace_back("--resume");
  ASSERT_EQ(run_sdm(into(out, again)).code, 0);
  expect_whole(more);
}
TEST_F(Resume, WithoutMapsOverTime) {
  interrupt({"--no-temporal"});
  ASSERT_EQ(run_sdm(into(out, {"--resume", "--no-temporal", "--threads", "1"})).code, 0);
  expect_whole({"--no-temporal"});
}

TEST_F(Resume, WithNothingToResumeStartsFromTheFirstFrame) {
  ASSERT_EQ(run_sdm(into(out, {"--resume"})).code, 0);
  expect_whole();
  ASSERT_EQ(run_sdm(into(out, {"--resume"})).code, 0);
  expect_whole();
}

TEST_F(Resume, WithoutTheOptionStartsFromTheFirstFrame) {
  interrupt();
  ASSERT_EQ(run_sdm(into(out)).code, 0);
  expect_whole();
}

TEST_F(Resume, ContinuesAfterABadFrame) {
  std::filesystem::remove(moving + "/20.obj");
  Outcome run = run_sdm(into(out));
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("20 earlier frames are in " + out));
  run = run_sdm(into(out, {"--resume"}));
  EXPECT_EQ(run.code, 1) << "the file is still missing";
  EXPECT_THAT(run.err, HasSubstr("20 earlier frames are in " + out));
  EXPECT_EQ(lines().size(), 21u);
  write_frame(20, shape(20));
  ASSERT_EQ(run_sdm(into(out, {"--resume"})).code, 0);
  expect_whole();
}

TEST_F(Resume, KeepsSkippedFrames) {
  write_frame(2, ring(10));  // another mesh
  std::filesystem::remove(moving + "/40.obj");
  interrupt({"--keep-going"}, 10);
  ASSERT_EQ(run_sdm(into(out, {"--resume", "--keep-going"})).code, 0);
  expect_whole({"--keep-going"});
}

TEST_F(Resume, RefusesOtherOptionsAndInputs) {
  interrupt();
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"--resolution", "64"},
                                                        {"--contact-margin", "0.1"},
                                                        {"--depth-precision", "0.1"},
                                                        {"--maps", "5"},
                                                        {"--units", "mm"},
                                                        {"--transform-o2", "translate:1:0:0"}}) {
    std::vector<std::string> arguments = into(out, {"--resume"});
    if (const auto at = std::ranges::find(arguments, option); at != arguments.end())
      at[1] = value;
    else
      arguments.insert(arguments.end(), {option, value});
    expect_refusal(arguments, "the interrupted run had another " + option);
  }
  expect_refusal(into(out, {"--resume", "--no-temporal"}), "--no-temporal");
  std::vector<std::string> other = into(out, {"--resume"});
  other[2] = o1;
  expect_refusal(other, o1 + " is not the mesh of the interrupted run");
  write_frame(3, ring(12, 1, {0, 0, 0.125}));
  expect_refusal(into(out, {"--resume"}), "frame 3 is not that of the interrupted run");
}

// All files, texel by texel.
TEST_F(Resume, AllowingTopologyChangesNothingWhereItDoesNotChange) {
  ASSERT_EQ(run_sdm(into(out, {"--allow-topology"})).code, 0);
  expect_whole();
}

/// Faces disappear and appear again, and once there is another mesh.
struct ResumeTopology : Resume {
  ResumeTopology() {
    for (int i = 0; i < kFrames; ++i) write_frame(i, changing(i));
  }
  static Mesh changing(int i) {
    Mesh mesh = i < 30 ? shape(i) : ring(14, 1, {0.25 * (i - 35), 0, 0.01 * i});
    const auto faces = mesh.triangles.begin() + (i % 5) * 20;
    if (i % 3 != 0) mesh.triangles.erase(faces, faces + 9 + i % 4);
    Mesh ball = moved(sphere(1), {0.125 * i, 2.5, 0});
    if (i % 7 < 3) ball.triangles.clear();  // its vertices stay in the file
    return joined(mesh, ball);
  }
};

TEST_F(ResumeTopology, EveryFrameIsAsByItself) {
  const std::string other = folder / "other";
  std::filesystem::create_directory(other);
  std::vector<Mesh> others;
  for (int i = 0; i < kFrames; ++i) {
    others.push_back(ring(16, 1, {0.3, 0, 0}));
    if (i >= 10) others.back().triangles.erase(others.back().triangles.begin() + 40 - i % 20);
    write_obj(std::filesystem::path(other) / (std::to_string(i) + ".obj"), others.back());
  }
  std::vector<std::string> arguments = into(out, {"--allow-topology"});
  arguments[2] = other;
  const Outcome run = run_sdm(arguments);
  ASSERT_EQ(run.code, 0) << run.err;
  const std::vector<Json> all = lines();
  ASSERT_EQ(all.size(), std::size_t{kFrames});
  std::size_t edits = 0, layouts = 0;
  for (int i = 0; i < kFrames; ++i) {
    SCOPED_TRACE(i);
    const Json& line = all[static_cast<std::size_t>(i)];
    ProximityQuery query(changing(i), others[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(line["separation"]["value"], query.separation().value, 1e-12);
    EXPECT_EQ(line["colliding"]["value"], query.colliding());
    ASSERT_EQ(line["penetration_depth"].is_null(), !query.penetration_depth().has_value());
    if (query.penetration_depth()) {
      EXPECT_LE(line["penetration_depth"]["lower"], query.penetration_depth()->upper);
      EXPECT_GE(line["penetration_depth"]["upper"], query.penetration_depth()->lower);
    }
    EXPECT_GT(line["error_bound"]["o1"], 0);
    if (!line.contains("topology")) continue;
    EXPECT_EQ(line["topology"].contains("o1"),
              i > 0 && (i == 30 || changing(i).triangles != changing(i - 1).triangles));
    if (!line["topology"].contains("o1")) continue;
    const Json& change = line["topology"]["o1"];
    EXPECT_EQ(change["new_layout"], i == 30);
    const auto faces = [&](int frame) { return static_cast<double>(changing(frame).triangles.size()); };
    EXPECT_EQ(faces(i) - faces(i - 1),
              change["added_faces"].get<double>() - change["removed_faces"].get<double>());
    ++(i == 30 ? layouts : edits);
  }
  EXPECT_EQ(layouts, 1u);
  EXPECT_GT(edits, 20u);
}

TEST_F(ResumeTopology, KeepsTheErrorBoundBelowAPrecision) {
  const std::vector<std::string> more{"--allow-topology", "--map-precision", "0.15"};
  interrupt(more, 25);
  std::vector<std::string> resume = into(out, more);
  resume.push_back("--resume");
  ASSERT_EQ(run_sdm(resume).code, 0);
  for (const Json& line : lines()) EXPECT_LE(line["error_bound"]["o1"], 0.15) << line["frame"];
  expect_whole(more);
}

// Unless it can be read later.
TEST_F(Resume, AFrameThatAppearsLaterMayNeedAFinerAtlas) {
  std::filesystem::remove(moving + "/20.obj");
  EXPECT_EQ(run_sdm(into(out, {"--map-precision", "0.1"})).code, 1);
  Mesh large = shape(20);
  for (Vec3& p : large.positions) p[2] *= 8;
  write_frame(20, large);
  ASSERT_EQ(run_sdm(into(out, {"--map-precision", "0.1", "--resume"})).code, 0);
  const std::vector<Json> all = lines();
  for (const Json& line : all) EXPECT_LE(line["error_bound"]["o1"], 0.1) << line["frame"];
  EXPECT_GT(all[20]["resolution"], all[19]["resolution"]);
  EXPECT_EQ(all[20]["topology"]["o1"]["new_layout"], true);
}

TEST_F(ResumeTopology, TheSummarySaysWhatChanged) {
  const Outcome run = run_sdm(sequence({"--allow-topology"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\n  topology   changes in "));
  EXPECT_THAT(run.out,
              HasSubstr("\n  note       frame 30 of O1 could not keep the layout of the frame before; "
                        "maps over time begin there\n"));
  EXPECT_EQ(run_sdm(sequence()).code, 1) << "without the option";
}

TEST_F(ResumeTopology, EndsWithTheFilesOfAnUninterruptedRun) {
  const std::size_t first = interrupt({"--allow-topology"}, 12);
  expect_refusal(into(out, {"--resume"}), "the interrupted run had another --allow-topology");
  EXPECT_GT(interrupt({"--allow-topology", "--resume"}, static_cast<int>(first) + 5), first);
  ASSERT_EQ(run_sdm(into(out, {"--allow-topology", "--resume"})).code, 0);
  expect_whole({"--allow-topology"});
}

// Each change is relative to the frame before it that could be read.
TEST_F(ResumeTopology, SkipsFramesThatCannotBeRead) {
  for (const int bad : {3, 13, 30, 40}) std::filesystem::remove(moving + "/" + std::to_string(bad) + ".obj");
  write_frame(20, ring(12, 1, {std::nan(""), 0, 0}));
  interrupt({"--allow-topology", "--keep-going"}, 15);
  ASSERT_EQ(run_sdm(into(out, {"--allow-topology", "--keep-going", "--resume"})).code, 0);
  expect_whole({"--allow-topology", "--keep-going"});
  for (const Json& line : lines())
    if (!line.contains("error")) {
      ProximityQuery query(changing(line["frame"]), read_mesh(o2));
      EXPECT_NEAR(line["separation"]["value"], query.separation().value, 1e-12) << line["frame"];
    }
}

TEST_F(Resume, RefusesADamagedState) {
  interrupt();
  std::filesystem::resize_file(out + "/resume.state", std::filesystem::file_size(out + "/resume.state") - 1);
  const Outcome run = run_sdm(into(out, {"--resume"}));
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(run.err, "sdm: error: " + out + "/resume.state is damaged; omit --resume to start again\n");
}

}  // namespace
}  // namespace sdm::test
