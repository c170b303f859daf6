// Every command that writes files, killed at any moment or short of memory.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/same_contents.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStaging = ".sdm-part-";

struct Command {
  std::string name;
  std::vector<std::string> arguments;
  std::string concluding;  ///< shows that the results are complete; in any subfolder

  friend void PrintTo(const Command& command, std::ostream* out) { *out << command.name; }
};

// Placeholders of the paths in TwoTori, and of a sequence.
const std::vector<Command> kCommands{
    {"map", {"map", "O1", "O2", "-o", "OUT"}, "report.json"},
    {"map_both", {"map", "O1", "O2", "--both", "-o", "OUT"}, "report.json"},
    {"map_cached", {"map", "O1", "O2", "--atlas-cache", "CACHE", "-o", "OUT"}, "report.json"},
    {"self", {"self", "O1", "-o", "OUT"}, "report.json"},
    {"bodies", {"bodies", "O1", "O2", "-o", "OUT"}, "report.json"},
    {"sequence", {"sequence", "FRAMES", "O2", "--maps", "2", "-o", "OUT"}, "frames.jsonl"},
    {"scene", {"scene", "letters", "--frames", "4", "-o", "OUT"}, "scene.json"},
    {"scene_ply", {"scene", "letters", "--frames", "4", "--format", "ply", "-o", "OUT"}, "scene.json"},
    {"info", {"info", "O1", "--self-intersections", "OUT/pairs.csv"}, "pairs.csv"},
    {"volume", {"volume", "O2", "--grid", "70", "70", "70", "--sites", "-o", "OUT/field.vti"}, "field.vti"}};

struct Termination : ::testing::TestWithParam<Command>, TwoTori {
  using Files = std::map<std::string, std::string>;  // contents by names relative to the folder

  std::string frames = folder / "frames", cache = folder / "first.atlas";

  Termination() {
    fs::create_directory(frames);
    for (int i = 0; i < 6; ++i)
      write_obj(fs::path(frames) / (std::to_string(i) + ".obj"), ring(12, 1, {0.1 * i, 0, 0}));
    write_obj(o1, joined(ring(12), ring(12, 1, {0.5, 0.1, 0})));  // intersects itself
  }
  [[nodiscard]] std::vector<std::string> command(const std::string& resolution) const {
    std::vector<std::string> arguments = GetParam().arguments;
    for (std::string& a : arguments) {
      if (a == "O1") a = o1;
      if (a == "O2") a = o2;
      if (a == "FRAMES") a = frames;
      if (a == "CACHE") a = cache;
      if (a.starts_with("OUT")) a.replace(0, 3, out);
    }
    const std::string& name = arguments[0];
    if (name != "scene" && name != "info" && name != "volume")
      arguments.insert(arguments.end(), {"--resolution", resolution});
    return arguments;
  }
  /// All files but the manifest and those in staging folders.
  [[nodiscard]] Files results() const {
    Files files;
    if (!fs::exists(out)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(out)) {
      const std::string name = fs::relative(entry.path(), out);
      if (entry.is_regular_file() && !name.starts_with(kStaging) && name != kManifest)
        files[name] = contents(entry.path());
    }
    return files;
  }
  [[nodiscard]] std::size_t staging_folders() const {
    if (!fs::exists(out)) return 0;
    return static_cast<std::size_t>(
        std::ranges::count_if(names_in(out), [](const auto& name) { return name.starts_with(kStaging); }));
  }
  static std::set<std::string> names(const Files& files) {
    std::set<std::string> result;
    for (const auto& [name, text] : files) result.insert(name);
    return result;
  }
  static bool has_times(const std::string& name) {
    return name.ends_with("report.json") || name.ends_with("report.html") || name.starts_with("frames.") ||
           name == "plot.png";
  }
  /// Each of the files is whole, and all of them are there if the results are said to be complete.
  static void expect_consistent(const Files& files, const Files& whole) {
    for (const auto& [name, text] : files) {
      ASSERT_TRUE(whole.contains(name)) << name;
      EXPECT_FALSE(text.empty()) << name;
      if (!has_times(name)) {
        EXPECT_TRUE(same_contents(name, text, whole.at(name))) << name;
      }
      if (name.ends_with("report.html")) {
        EXPECT_TRUE(text.ends_with("</html>\n")) << name;
      }
      if (fs::path(name).filename() == GetParam().concluding) {
        EXPECT_GE(files.size(), whole.size() - others(whole)) << name;
      }
    }
  }
  /// With --both, the report of one map can be moved before that of the other.
  static std::size_t others(const Files& whole) {
    const auto concluding = std::ranges::count_if(
        whole, [](const auto& file) { return fs::path(file.first).filename() == GetParam().concluding; });
    return static_cast<std::size_t>(concluding) - 1;
  }
};

INSTANTIATE_TEST_SUITE_P(Commands, Termination, ::testing::ValuesIn(kCommands),
                         [](const auto& command) { return command.param.name; });

// First without, then with the results of an earlier run in the folder.
TEST_P(Termination, AKilledRunLeavesNothingThatLooksLikeAResult) {
  const std::vector<std::string> arguments = command("128");
  (void)run_sdm(arguments);  // loads the program and the inputs into memory
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_sdm(arguments).code, 0);
  const std::chrono::duration<double, std::milli> duration = std::chrono::steady_clock::now() - start;
  const Files whole = results();
  const bool cached = GetParam().name == "map_cached";
  ASSERT_EQ(fs::exists(cache), cached);
  const std::string whole_cache = cached ? contents(cache) : "";
  fs::remove_all(out);
  int killed = 0;
  for (const bool earlier : {false, true}) {
    if (earlier) {
      ASSERT_EQ(run_sdm(arguments).code, 0);
      EXPECT_EQ(staging_folders(), 0u) << "left by a killed run";
      EXPECT_EQ(names(results()), names(whole));
    }
    constexpr int kMoments = 7;
    for (int i = 1; i <= kMoments; ++i) {
      const int ms = std::max(1, static_cast<int>(duration.count() * i / kMoments));
      SCOPED_TRACE(ms);
      fs::remove(cache);
      killed += run_sdm(arguments, {.kill_after_ms = ms}).code == 128 + SIGKILL;
      expect_consistent(results(), whole);
      if (fs::exists(cache)) {
        EXPECT_TRUE(contents(cache) == whole_cache);
      }
      EXPECT_LE(staging_folders(), 1u) << "those of earlier runs are removed";
    }
  }
  EXPECT_GT(killed, 0);
  ASSERT_EQ(run_sdm(arguments).code, 0);
  EXPECT_EQ(staging_folders(), 0u);
  EXPECT_EQ(names(results()), names(whole));
}

// At any limit: an error or a complete result.
TEST_P(Termination, LittleMemoryIsAnErrorWithoutFiles) {
  std::vector<std::string> arguments = command("512");
  if (arguments[0] != "info") arguments.insert(arguments.end(), {"--threads", "1"});
  ASSERT_EQ(run_sdm(arguments).code, 0);
  const std::set<std::string> whole = names(results());
  constexpr std::uint64_t kLeast = 20, kMost = 1024, kLimits = 10;  // MiB
  const auto run_with = [&](std::uint64_t mib) {
    fs::remove_all(out);
    return run_sdm(arguments, {.memory = mib << 20});
  };
  std::uint64_t enough = 2 * kLeast;
  while (enough < kMost && run_with(enough).code != 0) enough += enough / 4;
  ASSERT_LT(enough, kMost);
  int failed = 0;
  for (std::uint64_t i = 0; i < kLimits; ++i) {
    const std::uint64_t mib = kLeast + (enough - kLeast) * i / kLimits;
    SCOPED_TRACE(mib);
    const Outcome run = run_with(mib);
    if (run.code == 0) {
      EXPECT_EQ(names(results()), whole);
      continue;
    }
    ++failed;
    EXPECT_TRUE(run.code == 1 || run.code == 127) << run.code << ": " << run.err;  // 127: it cannot be loaded
    EXPECT_FALSE(fs::exists(out));
  }
  EXPECT_GT(failed, 0);
}

struct Staging : ::testing::Test, TwoTori {
  std::string staging = out + "/" + kStaging + "abcdef";
  Staging() {
    fs::create_directories(staging + "/files/o1");
    std::ofstream(staging + "/.sdm-staging");
  }
};

TEST_F(Staging, OfADeadProcessIsRemoved) {
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_FALSE(fs::exists(staging));
}

TEST_F(Staging, OfARunningProcessRemains) {
  const int file = open(staging.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_TRUE(fs::exists(staging + "/files/o1"));
  close(file);
  ASSERT_EQ(run_sdm(map()).code, 0);
  EXPECT_FALSE(fs::exists(staging));
}

}  // namespace
}  // namespace sdm::test
