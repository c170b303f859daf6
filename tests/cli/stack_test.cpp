// The command with little stack.
#include <gtest/gtest.h>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

// Triangles each a little smaller than the one before, towards a corner: an axis-aligned tree of them is as
// deep as it gets.
Mesh shrinking(double ratio) {
  Mesh mesh;
  for (double size = 1; size > 1e-28; size *= ratio) {
    const auto n = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) {
      Vec3 p{};
      p[k] = size;
      mesh.positions.push_back(p);
    }
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  return mesh;
}

struct Stack : ::testing::TestWithParam<std::string>, TwoTori {};

INSTANTIATE_TEST_SUITE_P(Commands, Stack,
                         ::testing::Values("map", "points", "info", "proximity", "hausdorff", "self",
                                           "volume", "bodies", "sequence"),
                         [](const auto& command) { return command.param; });

TEST_P(Stack, OfAHundredAndTwentyEightKilobytesIsEnough) {
#ifdef __SANITIZE_THREAD__
  constexpr std::uint64_t kStack = 2048 << 10;  // frames of instrumented code are several times as large
#else
  constexpr std::uint64_t kStack = 128 << 10;
#endif
  const std::string deep = write_obj(folder / "deep.obj", shrinking(0.93)),
                    tangled = write_obj(folder / "tangled.obj", joined(ring(24), ring(20, 1, {0.5, 0.1, 0}))),
                    round = write_obj(folder / "round.obj", sphere(3));
  const std::string cloud = folder / "cloud.xyz";
  {
    std::ofstream file(cloud);
    for (const Vec3& p : sphere(2).positions) file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  }
  const std::string& name = GetParam();
  for (const std::string& a : {tangled, deep})
    for (const std::string& b : {round, deep}) {
      SCOPED_TRACE(a + ' ' + b);
      std::vector<std::string> arguments{name};
      if (name == "points")
        arguments.insert(arguments.end(), {cloud, b, "-o", out});
      else if (name == "info")
        arguments.insert(arguments.end(), {a, "--self-intersections", folder / "pairs.csv"});
      else if (name == "volume")
        arguments.insert(arguments.end(), {b, "--grid", "12", "12", "12", "-o", folder / "field.vti"});
      else if (name == "self")
        arguments.insert(arguments.end(), {a, "--resolution", "128", "-o", out});
      else if (name == "hausdorff" || name == "proximity")
        arguments.insert(arguments.end(), {a, b});
      else
        arguments.insert(arguments.end(), {a, b, "--resolution", "128", "-o", out});
      const Outcome run = run_sdm(arguments, {.stack = kStack});
      EXPECT_EQ(run.code, 0) << run.out << run.err;
      std::filesystem::remove_all(out);
    }
}

}  // namespace
}  // namespace sdm::test
