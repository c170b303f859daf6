// Every command, interrupted at any moment of work that would go on for long: it ends soon, and leaves
// nothing half-written.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

namespace fs = std::filesystem;

struct LongCommand {
  std::string name;
  std::vector<std::string> arguments;

  friend void PrintTo(const LongCommand& command, std::ostream* out) { *out << command.name; }
};

// Each runs for a second at least, most of them for minutes.
const std::vector<LongCommand> kLongCommands{
    {"map", {"map", "FINE", "FINE2", "-o", "OUT", "--resolution", "4096"}},
    {"map_winding", {"map", "FINE", "OPEN", "-o", "OUT", "--resolution", "2048", "--sign", "winding"}},
    {"map_align", {"map", "FINE", "SPHERES", "-o", "OUT", "--resolution", "4096", "--align"}},
    {"points", {"points", "CLOUD", "SPHERES", "-o", "OUT"}},
    {"hausdorff", {"hausdorff", "FINE", "SPHERES", "--precision", "1e-9"}},
    {"metrics", {"metrics", "FINE", "SPHERES"}},
    {"proximity", {"proximity", "FINE", "SPHERES"}},
    {"bodies", {"bodies", "FINE", "SPHERES", "NEEDLES", "-o", "OUT", "--resolution", "2048"}},
    {"sequence", {"sequence", "FRAMES", "SPHERES", "--maps", "1", "-o", "OUT", "--resolution", "2048"}},
    {"self", {"self", "NEEDLES", "-o", "OUT", "--resolution", "2048"}},
    {"volume", {"volume", "SPHERES", "--grid", "700", "700", "700", "-o", "OUT/field.vti"}},
    {"info", {"info", "NEEDLES"}},
    {"scene", {"scene", "cloth", "--frames", "100000", "-o", "OUT"}}};

/// n triangles along x and n along y, each of which crosses all of the others.
Mesh crossing_needles(int n) {
  Mesh mesh;
  for (int i = 0; i < 2 * n; ++i) {
    const double at = static_cast<double>(i / 2) / n, width = 0.3 / n;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : {Vec3{-1, at, -0.1}, Vec3{2, at, 0.1}, Vec3{2, at + width, 0.2}})
      mesh.positions.push_back(i % 2 == 0 ? p : Vec3{p[1], p[0], -p[2]});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

struct Interrupt : ::testing::TestWithParam<LongCommand> {
  TemporaryFolder folder;
  std::string inputs = folder / "in", out = folder / "out";
  std::string fine, fine2, spheres, open, needles, frames, cloud;

  Interrupt() {
    fs::create_directory(inputs);
    const fs::path in = inputs;
    fine = write_obj(in / "fine.obj", ring(160));
    fine2 = write_obj(in / "fine2.obj", ring(170, 1, {0.05, 0, 0}));
    needles = write_obj(in / "needles.obj", crossing_needles(3000));
    Mesh many;  // spheres that overlap
    for (int i = 0; i < 40; ++i)
      many = joined(many, moved(sphere(3), {0.31 * (i % 4), 0.29 * (i / 4 % 4), 0.27 * (i / 16)}));
    spheres = write_obj(in / "spheres.obj", many);
    for (std::size_t f = 0; f < many.triangles.size(); f += 100)  // holes: the sign is an estimate
      std::ranges::fill(many.triangles[f], many.triangles[f][0]);
    std::erase_if(many.triangles, is_removed);
    open = write_obj(in / "open.obj", many);
    cloud = in / "cloud.xyz";
    std::ofstream points(cloud);
    for (int i = 0; i < 200000; ++i)  // scattered over the spheres
      points << 0.001 * (i * 7 % 997) << ' ' << 0.001 * (i * 11 % 991) << ' ' << 0.001 * (i * 13 % 983)
             << '\n';
    frames = in / "frames";
    fs::create_directory(frames);
    for (int i = 0; i < 40; ++i)
      write_obj(fs::path(frames) / (std::to_string(100 + i) + ".obj"), ring(60, 1, {0.02 * i, 0, 0}));
  }
  [[nodiscard]] std::vector<std::string> arguments() const {
    std::vector<std::string> result = GetParam().arguments;
    for (std::string& a : result) {
      if (a == "FINE") a = fine;
      if (a == "FINE2") a = fine2;
      if (a == "SPHERES") a = spheres;
      if (a == "OPEN") a = open;
      if (a == "NEEDLES") a = needles;
      if (a == "FRAMES") a = frames;
      if (a == "CLOUD") a = cloud;
      if (a.starts_with("OUT")) a.replace(0, 3, out);
    }
    return result;
  }
};

INSTANTIATE_TEST_SUITE_P(Commands, Interrupt, ::testing::ValuesIn(kLongCommands),
                         [](const auto& command) { return command.param.name; });

// Measured by the time of the processor, so that other processes do not matter. Half a second after the
// signal the command ends even where it does not poll, which all cores of a machine may spend.
TEST_P(Interrupt, EndsSoonAndLeavesNothingHalfWritten) {
  constexpr double kMost = 8;  // seconds of all threads; one that is slowed down by sanitizers too
  int interrupted = 0;
  for (const auto& [ms, signal] :
       {std::pair(20, SIGTERM), std::pair(90, SIGINT), std::pair(350, SIGTERM), std::pair(1000, SIGINT)}) {
    SCOPED_TRACE(ms);
    const Outcome run = run_sdm(arguments(), {.interrupt_after_ms = ms, .signal = signal});
    EXPECT_LT(run.cpu_after_signal, kMost);
    if (run.code == 0) {  // on a fast machine
      fs::remove_all(out);
      break;
    }
    ASSERT_EQ(run.code, 128 + signal) << run.err;
    ++interrupted;
    if (GetParam().name == "sequence" && run.err.find("frames are in") != std::string::npos) {
      EXPECT_TRUE(fs::exists(fs::path(out) / "frames.jsonl"));  // those that were finished
      for (const std::string& name : names_in(out)) EXPECT_FALSE(name.starts_with('.')) << name;
      fs::remove_all(out);
    }
    EXPECT_FALSE(fs::exists(out));
    EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"in"});
  }
  EXPECT_GT(interrupted, 0);
}

// A system call that waits for a reader cannot poll.
TEST(InterruptBlocked, EndsAWriteThatNeverReturns) {
  const TemporaryFolder folder;
  const std::string mesh = write_obj(folder / "mesh.obj", sphere(1)), pipe = folder / "pipe.csv";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Outcome run =
      run_sdm({"info", mesh, "--self-intersections", pipe}, {.interrupt_after_ms = 1000, .signal = SIGTERM});
  EXPECT_EQ(run.code, 128 + SIGTERM);
  EXPECT_EQ(run.out, "");
}

}  // namespace
}  // namespace sdm::test
