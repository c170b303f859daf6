// Several runs into one folder at the same time, and what else is in that folder.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/samples.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using FileContents = std::map<std::string, std::string>;  // by names relative to the folder

FileContents files_in(const fs::path& folder) {
  FileContents files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder)] = contents(entry.path());
  return files;
}

/// The same without the manifest.
FileContents results_in(const fs::path& folder) {
  FileContents files = files_in(folder);
  EXPECT_EQ(files.erase(kManifest), 1u);
  return files;
}

/// A lock on the output folder, as a run that moves its files has.
class HeldFolder {
 public:
  explicit HeldFolder(const std::string& folder) {
    fs::create_directory(folder);
    file_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    EXPECT_EQ(flock(file_, LOCK_EX | LOCK_NB), 0);
  }
  ~HeldFolder() { release(); }
  HeldFolder(const HeldFolder&) = delete;
  HeldFolder& operator=(const HeldFolder&) = delete;
  void release() {
    if (file_ >= 0) close(file_);
    file_ = -1;
  }

 private:
  int file_ = -1;
};

struct ConcurrentRuns : ::testing::Test, TwoTori {};

// Each variant writes other files of other contents.
TEST_F(ConcurrentRuns, IntoOneFolderGiveTheCompleteResultOfOne) {
  const std::vector<std::vector<std::string>> variants{{"--resolution", "64", "--write", "exr,png"},
                                                       {"--resolution", "72", "--write", "exr,glb"},
                                                       {"--resolution", "80", "--write", "exr", "--both"},
                                                       {"--resolution", "88", "--write", "png,glb"}};
  const auto arguments = [&](std::size_t variant, const std::string& place) {
    std::vector<std::string> all{"map", o1, o2, "-o", place, "--threads", "1"};
    all.insert(all.end(), variants[variant].begin(), variants[variant].end());
    return all;
  };
  const auto resolution_of = [](FileContents& files) {
    const std::string& report = files[files.contains("o1/report.json") ? "o1/report.json" : "report.json"];
    return nlohmann::json::parse(report).at("atlas").at("resolution").get<int>();
  };
  std::map<int, FileContents> alone;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const std::string place = folder / ("alone" + std::to_string(i));
    const Outcome run = run_sdm(arguments(i, place));
    ASSERT_EQ(run.code, 0) << run.err;
    FileContents files = results_in(place);
    const int resolution = resolution_of(files);
    alone[resolution] = std::move(files);
  }
  ASSERT_EQ(alone.size(), variants.size());
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Outcome> runs(variants.size());
    {
      std::vector<std::jthread> threads;
      for (std::size_t i = 0; i < variants.size(); ++i)
        threads.emplace_back([&, i] { runs[i] = run_sdm(arguments(i, out)); });
    }
    for (const Outcome& run : runs) EXPECT_EQ(run.code, 0) << run.err;
    FileContents found = results_in(out);
    const int resolution = resolution_of(found);
    ASSERT_TRUE(alone.contains(resolution));
    const FileContents& whole = alone[resolution];
    ASSERT_EQ(found.size(), whole.size()) << resolution;
    for (const auto& [name, text] : whole) {
      ASSERT_TRUE(found.contains(name)) << name;
      if (name.ends_with("report.json")) continue;  // contains times
      EXPECT_TRUE(found[name] == text) << name << " of another run than " << resolution;
    }
  }
}

TEST_F(ConcurrentRuns, WaitWhileAnotherOneMovesItsFiles) {
  HeldFolder other(out);
  Outcome run;
  {
    std::jthread thread([&] { run = run_sdm(map()); });
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    for (const std::string& name : names_in(out)) EXPECT_TRUE(name.starts_with(".sdm-part-")) << name;
    other.release();
  }
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names_in(out), kResults);
}

TEST_F(ConcurrentRuns, AreInterruptedWhileTheyWait) {
  const HeldFolder other(out);
  for (const int signal : {SIGINT, SIGTERM}) {
    const Outcome run = run_sdm(map(), {.interrupt_after_ms = 1500, .signal = signal});
    EXPECT_EQ(run.code, 128 + signal);
    EXPECT_THAT(run.err, HasSubstr("cancelled"));
    EXPECT_TRUE(fs::is_empty(out));
  }
}

TEST_F(ConcurrentRuns, KilledWhileTheyWaitBlockNobody) {
  {
    const HeldFolder other(out);
    EXPECT_EQ(run_sdm(map(), {.kill_after_ms = 1500}).code, 128 + SIGKILL);
  }
  EXPECT_EQ(run_sdm(map()).code, 0);
  EXPECT_EQ(names_in(out), kResults);
}

// The name alone does not make a folder one of sdm's.
TEST_F(ConcurrentRuns, LeaveFoldersOfTheUserAlone) {
  const fs::path mine = fs::path(out) / ".sdm-part-mine", empty = fs::path(out) / ".sdm-part-abcdef";
  fs::create_directories(mine / "files");
  fs::create_directories(empty);
  std::ofstream(mine / "files" / "thesis.txt") << "words";
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_EQ(contents(mine / "files" / "thesis.txt"), "words");
  EXPECT_TRUE(fs::exists(empty));
}

// A process can be killed before it marks the folder that it has created.
TEST_F(ConcurrentRuns, RemoveEmptyFoldersThatAKilledRunHasNotMarked) {
  const std::string staging = out + "/.sdm-part-abcdef";
  fs::create_directory(out);
  ASSERT_EQ(mkdir(staging.c_str(), S_ISVTX | S_IRWXU), 0);
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_FALSE(fs::exists(staging));
}

// Not even what a user has put into a staging folder.
TEST_F(ConcurrentRuns, RemoveFromAbandonedFoldersOnlyWhatTheyPutThere) {
  const fs::path staging = fs::path(out) / ".sdm-part-abcdef";
  fs::create_directories(staging / "files");
  std::ofstream(staging / ".sdm-staging");
  std::ofstream(staging / "files" / "map.exr") << "a part";
  std::ofstream(staging / "thesis.txt") << "words";
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_EQ(names_in(staging), std::vector<std::string>{"thesis.txt"});
}

TEST_F(ConcurrentRuns, WithFewerBodiesOrFramesLeaveNoneOfMore) {
  const auto bodies = [&](std::vector<std::string> files) {
    files.insert(files.begin(), "bodies");
    files.insert(files.end(), {"-o", out, "--resolution", "64"});
    return run_sdm(files).code;
  };
  ASSERT_EQ(bodies({o1, o2, o1}), 0);
  ASSERT_TRUE(fs::exists(out + "/2"));
  ASSERT_EQ(bodies({o1, o2}), 0);
  EXPECT_FALSE(fs::exists(out + "/2"));

  const std::string scene = folder / "scene";
  const auto frames = [&](const char* count) {
    return run_sdm({"scene", "letters", "--format", "ply", "--frames", count, "-o", scene}).code;
  };
  ASSERT_EQ(frames("4"), 0);
  const FileContents four = results_in(scene);
  ASSERT_EQ(frames("2"), 0);
  EXPECT_EQ(results_in(scene).size() - 1, (four.size() - 1) / 2) << "besides scene.json";
}

// The frames before the interrupt are those in the folder, or the run would mix two.
TEST_F(ConcurrentRuns, AResumedRunIsRefusedIfAnotherOneHasChangedTheFolder) {
  const std::string frames = folder / "frames";
  fs::create_directory(frames);
  for (int i = 0; i < 6; ++i)
    write_obj(fs::path(frames) / (std::to_string(i) + ".obj"), ring(12, 1, {0.1 * i, 0, 0}));
  std::ofstream(fs::path(frames) / "6.obj") << "v 0 0\n";  // a bad frame: the run is incomplete
  const std::vector<std::string> run{"sequence", frames, o2, "--resolution", "64", "-o", out, "--maps", "1"};
  ASSERT_EQ(run_sdm(run).code, 1);
  ASSERT_TRUE(fs::exists(out + "/resume.state"));
  std::vector<std::string> resume = run;
  resume.emplace_back("--resume");
  write_obj(fs::path(frames) / "6.obj", ring(12, 1, {0.6, 0, 0}));
  Outcome late;
  {
    HeldFolder other(out);
    std::jthread thread([&] { late = run_sdm(resume); });
    for (int i = 0; i < 6000 && names_in(out).front().rfind(".sdm-part-", 0) != 0;
         ++i)  // it reads the state first
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    fs::remove(out + "/resume.state");
    other.release();
  }
  EXPECT_EQ(late.code, 1);
  EXPECT_THAT(late.err, HasSubstr("another run has changed it"));
}

}  // namespace
}  // namespace sdm::test
