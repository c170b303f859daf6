#include "cli/samples.h"
#include "support/run_sdm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Failure : ::testing::Test, TwoTori {
  /// The command fails with one sentence that names `thing`, and leaves no files.
  void expect_failure(const Outcome& run, const std::string& thing, int code = 1) {
    EXPECT_EQ(run.code, code) << run.out << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, StartsWith("sdm: error: "));
    EXPECT_THAT(run.err, HasSubstr(thing));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(names_in(folder.path()), before) << thing;
  }
  std::vector<std::string> before = names_in(folder.path());
};

TEST_F(Failure, BadInputIsNamed) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> bad{
      {"empty.obj", ""},
      {"no_triangles.obj", v},
      {"index.obj", v + "f 1 2 4\n"},
      {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"infinite.obj", "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"},
      {"garbage.stl", std::string("\x01\x02\xff\x00\x7f garbage\0", 14)},
      {"truncated.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"},
      {"truncated.off", "OFF\n3 1 0\n0 0 0\n1 0"},
      {"garbage.glb", "glTF\x02"},
  };
  for (const auto& [name, text] : bad) std::ofstream(folder / name, std::ios::binary) << text;
  before = names_in(folder.path());
  for (const auto& [name, text] : bad) {
    expect_failure(run_sdm({"map", folder / name, o2, "-o", out}), name);
    expect_failure(run_sdm({"map", o1, folder / name, "-o", out}), name);
  }
  expect_failure(run_sdm({"map", o1, folder / "missing.obj", "-o", out}), "missing.obj");
  expect_failure(run_sdm({"map", o1, folder.path(), "-o", out}), folder.path());
}

// Regression: reading a pipe waited for a writer, and /dev/zero was read until memory ended.
TEST_F(Failure, PipesAndDevicesAreRefusedAtOnce) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  before = names_in(folder.path());
  for (const std::string& file : {pipe, std::string("/dev/zero")})
    for (const std::vector<std::string>& command : {map({"--tolerance-table", file}),
                                                    map({"--align-321", file}),
                                                    map({"--transform-o1", "matrix:" + file}),
                                                    {"points", file, o2, "-o", out},
                                                    {"bodies", o1, o2, "--poses", file, "-o", out}}) {
      const Outcome run = run_sdm(command, {.memory = std::uint64_t{1} << 30});
      SCOPED_TRACE(command[0]);
      expect_failure(run, file + ": this is not a regular file");
    }
}

// Models of a few hundred bytes that declare, or name a hundred times, more than the memory that there is.
TEST_F(Failure, ModelsThatDeclareMoreThanTheyHoldTakeLittleMemory) {
  constexpr std::uint64_t kMemory = std::uint64_t{512} << 20;
  const std::string triangle =
      R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3},{"componentType":5126,"type":"VEC3","count":90000000,)"
      R"("sparse":{"count":1,"indices":{"componentType":5121,"bufferView":0},"values":{"bufferView":0}}}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)";
  const std::string buffer =
      R"({"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  const auto model = [&](const std::string& node, const std::string& primitive) {
    return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0)" + node + R"(}],"meshes":[{"primitives":[{)" +
           primitive + R"(}]}],"accessors":[)" + triangle;
  };
  const std::string file = folder / "hostile.gltf";
  for (const std::string& text :
       {model("", R"("attributes":{"POSITION":1})"),
        model(R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}})",
              R"("attributes":{"POSITION":0})"),
        model(R"(,"weights":[1])", R"("attributes":{"POSITION":1},"targets":[{"POSITION":1}])")}) {
    std::ofstream(file) << text << buffer;
    before = names_in(folder.path());
    expect_failure(run_sdm({"map", file, o2, "-o", out}, {.memory = kMemory}), "hostile.gltf: ");
    EXPECT_THAT(run_sdm({"info", file}, {.memory = kMemory}).err, HasSubstr("would take"));
  }
  // The first buffer is the triangle; the others are one file of 20 MB.
  std::ofstream(folder / "large.bin") << "large";
  std::filesystem::resize_file(folder / "large.bin", std::size_t{20} << 20);
  std::string names = buffer.substr(0, buffer.size() - 2);
  for (int i = 0; i < 100; ++i) names += R"(,{"byteLength":5,"uri":"large.bin"})";
  std::ofstream(file) << model("", R"("attributes":{"POSITION":0})") << names << "]}";
  const Outcome run = run_sdm({"info", file}, {.memory = kMemory});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("triangles           1\n"));
}

TEST_F(Failure, AFullDiskLeavesNoTrace) {
  for (const std::uint64_t bytes : {0, 500, 4000, 30000})
    expect_failure(run_sdm(map({"--both"}), {.file_size = bytes}), "cannot write");
}

TEST_F(Failure, AFullDiskLeavesNoTraceOfAnyCommand) {
  const std::string moving = folder / "moving";
  std::filesystem::create_directory(moving);
  for (int i = 0; i < 3; ++i)
    write_obj(std::filesystem::path(moving) / (std::to_string(i) + ".obj"), ring(12, 1, {0.1 * i, 0, 0}));
  before = names_in(folder.path());
  const std::vector<std::vector<std::string>> commands{
      {"self", o1, "--resolution", "64"},
      {"bodies", o1, o2, "--resolution", "64"},
      {"sequence", moving, o2, "--resolution", "64", "--maps", "1"},
      {"sequence", moving, o2, "--resolution", "64", "--no-temporal"},
      {"scene", "letters", "--frames", "2"},
      {"scene", "letters", "--frames", "2", "--format", "ply"}};
  for (std::vector<std::string> command : commands) {
    SCOPED_TRACE(command[0]);
    command.insert(command.end(), {"-o", out});
    for (const std::uint64_t bytes : {0, 500}) {
      const Outcome run = run_sdm(command, {.file_size = bytes});
      expect_failure(run, "cannot write " + out + "/");  // the final path, not that of the staged file
      EXPECT_THAT(run.err, Not(HasSubstr(".sdm-part")));
    }
  }
}

TEST_F(Failure, AFullDiskLeavesEarlierResultsAlone) {
  ASSERT_EQ(run_sdm(map()).code, 0);
  const auto earlier = names_in(out);
  const std::string exr = contents(out + "/map.exr");
  EXPECT_EQ(run_sdm(map({"--resolution", "256"}), {.file_size = 20000}).code, 1);
  EXPECT_EQ(names_in(out), earlier);
  EXPECT_EQ(contents(out + "/map.exr"), exr);
}

TEST_F(Failure, AFolderThatCannotBeWrittenToIsRefusedBeforeAnyWork) {
  // O1 does not exist either: the folder is looked at first.
  const auto into = [&](const std::string& place) {
    return run_sdm({"map", folder / "missing.obj", o2, "-o", place});
  };
  expect_failure(into(o1), "first.obj");
  expect_failure(into(o1 + "/below"), "first.obj");
  expect_failure(into("/proc/sdm/out"), "/proc/sdm");
  if (geteuid() != 0) {
    std::filesystem::permissions(folder.path(),
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    expect_failure(into(out), out);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  }
}

TEST_F(Failure, AResultWhosePlaceIsTakenByAFolderReplacesNothing) {
  std::filesystem::create_directories(out + "/model.glb");
  const Outcome run = run_sdm(map());
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("model.glb"));
  EXPECT_EQ(names_in(out), std::vector<std::string>{"model.glb"});
}

TEST_F(Failure, ResolutionsTooSmallForTheCharts) {
  write_obj(o1, ring(60));
  expect_failure(run_sdm({"map", o1, o2, "-o", out, "--resolution", "16", "--atlas", "triangles"}), "16");
}

// 32768² texels take tens of gigabytes.
TEST_F(Failure, ResolutionsTooLargeForTheMemory) {
  write_obj(o1, ring(60));
  expect_failure(run_sdm(map({"--resolution", "32768"}), {.memory = std::uint64_t{2} << 30}), "memory");
}

TEST_F(Failure, OptionsThatTheMeshesDoNotAllow) {
  // Often, because the atlas fails while O2 is being prepared on the other cores.
  for (int repeat = 0; repeat < 10; ++repeat)
    expect_failure(run_sdm(map({"--atlas", "uv"})), "texture coordinates");
  expect_failure(run_sdm(map({"--atlas", "uv"})), "--atlas charts");
  Mesh open = ring(16);
  open.triangles.resize(100);
  write_obj(o2, open);
  expect_failure(run_sdm(map({"--sign", "exact"})), "O2 is open");
  expect_failure(run_sdm(map({"--sign", "exact"})), "(--sign)");
}

TEST_F(Failure, AnInterruptedRunLeavesNoTrace) {
  write_obj(o1, ring(250));
  write_obj(o2, ring(250, 1, {0.3, 0, 0}));
  const Outcome run = run_sdm({"map", o1, o2, "-o", out, "--resolution", "4096", "--engine", "reference"},
                              {.interrupt_after_ms = 1500});
  expect_failure(run, "cancelled", 128 + SIGINT);  // as a shell expects that is to end its loop
}

}  // namespace
}  // namespace sdm::test
