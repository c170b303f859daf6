// `sdm scene` as a user runs it: the files are what MeshSequence reads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct SceneCommand : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out";

  [[nodiscard]] nlohmann::json description() const {
    return nlohmann::json::parse(contents(out + "/scene.json"));
  }
  [[nodiscard]] MeshSequence sequence(std::size_t body) const {
    return MeshSequence(out + "/" + description()["bodies"][body]["sequence"].get<std::string>());
  }
};

TEST_F(SceneCommand, FilesAreSequences) {
  const Outcome run = run_sdm({"scene", "figure", "-o", out, "--frames", "4"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("4 frames of 0.0166667 s"));
  EXPECT_THAT(names_in(out), ElementsAre("box.ply", "figure.npy", "figure.ply", "scene.json"));
  EXPECT_EQ(description()["scene"], "figure");
  EXPECT_EQ(description()["frames"], 4);
  EXPECT_DOUBLE_EQ(description()["time_step"], 1.0 / 60);
  for (std::size_t body = 0; body < 2; ++body) {
    MeshSequence frames = sequence(body);
    EXPECT_EQ(frames.frame_count(), body == 0 ? 4u : 1u);
    EXPECT_EQ(frames.mesh().triangles.size(), description()["bodies"][body]["triangles"]);
    EXPECT_EQ(description()["bodies"][body]["moves"], body == 0);
  }
}

TEST_F(SceneCommand, BothFormatsHoldTheSameFrames) {
  ASSERT_EQ(run_sdm({"scene", "letters", "-o", out, "--frames", "3", "--quiet"}).out, "");
  MeshSequence npy = sequence(1);
  out += "2";
  ASSERT_EQ(
      run_sdm({"scene", "letters", "-o", out, "--frames", "3", "--format", "ply", "--threads", "1"}).code, 0);
  EXPECT_THAT(names_in(out), ElementsAre("E", "G", "scene.json"));
  EXPECT_THAT(names_in(out + "/G"), ElementsAre("00000.ply", "00001.ply", "00002.ply"));
  MeshSequence ply = sequence(1);
  EXPECT_EQ(ply.mesh().triangles, npy.mesh().triangles);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    const auto a = npy.positions(frame), b = ply.positions(frame);
    for (std::size_t v = 0; v < b.size(); ++v)
      for (int k = 0; k < 3; ++k) ASSERT_EQ(a[v][k], static_cast<double>(static_cast<float>(b[v][k])));
  }
}

TEST_F(SceneCommand, ATearingClothIsWrittenAsNumberedFiles) {
  ASSERT_EQ(run_sdm({"scene", "tear", "-o", out, "--frames", "60"}).code, 0);
  EXPECT_THAT(names_in(out), ElementsAre("ball.npy", "ball.ply", "cloth", "floor.ply", "scene.json"));
  EXPECT_EQ(names_in(out + "/cloth").size(), 60u);
  EXPECT_EQ(description()["bodies"][0]["tears"], true);
  EXPECT_EQ(description()["bodies"][1]["tears"], false);
  // More vertices at the end than at the start, and as many faces.
  const Mesh first = read_mesh(out + "/cloth/00000.ply"), last = read_mesh(out + "/cloth/00059.ply");
  EXPECT_EQ(first.triangles.size(), last.triangles.size());
  EXPECT_GT(last.positions.size(), first.positions.size());
  EXPECT_EQ(sequence(1).frame_count(), 60u);
}

TEST_F(SceneCommand, BunniesAreMadeOfTheMeshGiven) {
  const std::string mesh = write_obj(folder / "torus.obj", ring(60));
  ASSERT_EQ(run_sdm({"scene", "bunnies", "-o", out, "--frames", "2", "--mesh", mesh}).code, 0);
  EXPECT_NEAR(description()["bodies"][0]["triangles"].get<double>(), 2000, 20);
  std::ofstream(folder / "bad.obj") << "v 0 0 0\n";
  const Outcome run = run_sdm({"scene", "bunnies", "-o", folder / "never", "--mesh", folder / "bad.obj"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("bad.obj: "));
  EXPECT_FALSE(std::filesystem::exists(folder / "never"));
}

TEST_F(SceneCommand, WrongUsageEndsWithTwo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"scene"},
                                                    {"scene", "letters"},
                                                    {"scene", "numbers", "-o", out},
                                                    {"scene", "letters", "-o", ""},
                                                    {"scene", "letters", "-o", out, "--frames", "0"},
                                                    {"scene", "letters", "-o", out, "--frames", "many"},
                                                    {"scene", "letters", "-o", out, "--format", "obj"},
                                                    {"scene", "letters", "-o", out, "--threads", "-1"},
                                                    {"scene", "letters", "-o", out, "--mesh", "bunny.obj"}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2) << arguments.back() << run.err;
    EXPECT_NE(run.err, "");
    EXPECT_EQ(run.out, "");
  }
  const Outcome no_part = run_sdm({"scene", "scan", "-o", out});
  EXPECT_EQ(no_part.code, 2);
  EXPECT_THAT(no_part.err,
              HasSubstr("scene scan needs --mesh FILE, the part: a closed mesh with a flat place"));
  EXPECT_THAT(run_sdm({"scene", "--help"}).out, HasSubstr("Example"));
  EXPECT_TRUE(folder.empty());
}

TEST_F(SceneCommand, AFullDiskOrAnInterruptLeavesNoTrace) {
  const Outcome full = run_sdm({"scene", "letters", "-o", out, "--frames", "20"}, {.file_size = 100000});
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, HasSubstr("cannot write"));
  const Outcome interrupted =
      run_sdm({"scene", "cloth", "-o", out, "--frames", "100000"}, {.interrupt_after_ms = 1000});
  EXPECT_EQ(interrupted.code, 128 + SIGINT);
  EXPECT_THAT(interrupted.err, HasSubstr("cancelled"));
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace sdm::test
