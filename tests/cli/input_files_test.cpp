// No command replaces or removes what it reads, nor removes what it has not written.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cli/samples.h"
#include "support/every_case.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Arguments = std::vector<std::string>;

/// The contents of all files, also those behind links, and where links lead to.
std::map<std::string, std::string> all_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::string& text = files[fs::relative(entry.path().parent_path(), folder) / entry.path().filename()];
    if (entry.is_symlink()) text = "-> " + fs::read_symlink(entry.path()).string() + '\n';
    if (entry.is_regular_file()) text += contents(entry.path());
  }
  return files;
}

/// Writes a mesh as PLY, whatever the name of the file is.
void write_as_ply(const fs::path& file, const Mesh& mesh) {
  const TemporaryFolder folder;
  write_mesh(folder / "mesh.ply", mesh);
  fs::copy_file(folder / "mesh.ply", file, fs::copy_options::overwrite_existing);
}

struct InputFiles : ::testing::Test {
  TemporaryFolder folder;
  fs::path d = folder / "d";

  InputFiles() { fs::create_directory(d); }

  /// A small solid as PLY, whatever the name is.
  std::string mesh(const fs::path& file, double size = 0.9) const {
    fs::create_directories(file.parent_path());
    write_as_ply(file, cube(size));
    return file;
  }
  void text(const fs::path& file, const std::string& words) const { std::ofstream(file) << words; }

  /// The run is an error that names both files, and leaves everything as it is.
  void expect_refusal(const Arguments& arguments, const fs::path& output, const fs::path& input) const {
    SCOPED_TRACE(fmt::format("sdm {}", fmt::join(arguments, " ")));
    const auto before = all_in(folder.path());
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 1) << run.out;
    EXPECT_THAT(run.err, AllOf(HasSubstr(output.filename().string() + ": it is the input"),
                               HasSubstr(input.filename().string())));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_TRUE(all_in(folder.path()) == before) << "a file was changed";
  }
};

// Regressions: each of these deleted or replaced its input.
TEST_F(InputFiles, ThatARunWouldNotWriteRemain) {
  const std::string o1 = mesh(d / "model.glb"), o2 = mesh(d / "box.ply", 1), page = mesh(d / "report.html");
  const std::string table = contents(o1);
  for (const Arguments& command :
       {Arguments{"map", o1, o2}, {"self", page}, {"thickness", o1}, {"bodies", o1, page}}) {
    Arguments run = command;
    run.insert(run.end(), {"-o", d, "--resolution", "16", "--write", "exr"});
    EXPECT_EQ(run_sdm(run).code, 0) << command[0];
    EXPECT_EQ(contents(o1), table);
    EXPECT_EQ(contents(page), table);
  }
}

TEST_F(InputFiles, AreNotReplaced) {
  const std::string box = mesh(d / "box.ply", 1), elsewhere = folder / "other";
  const auto refuse = [&](const Arguments& arguments, const fs::path& file) {
    expect_refusal(arguments, file, file);
  };
  const std::string points = mesh(d / "points.ply"), vertices = mesh(d / "vertices.ply"),
                    baked = mesh(d / "baked.glb"), report = mesh(d / "report.json"),
                    normals = mesh(d / "normal.png"), finer = mesh(d / "a_lod1.ply");
  refuse({"points", points, box, "-o", d}, points);
  refuse({"points", box, report, "-o", d}, report);
  refuse({"map", vertices, box, "-o", d, "--write", "ply"}, vertices);
  refuse({"map", box, vertices, "-o", d, "--write", "ply"}, vertices);
  refuse({"self", vertices, "-o", d, "--write", "ply"}, vertices);
  refuse({"thickness", report, "-o", d, "--write", "none"}, report);
  refuse({"bake", box, baked, "-o", d, "--channels", "normal"}, baked);
  refuse({"bake", normals, box, "-o", d, "--channels", "normal", "--resolution", "16"}, normals);
  refuse({"simplify", finer, "-o", d / "a.ply", "--triangles", "50%", "--lods", "2"}, finer);
  refuse({"simplify", vertices, "-o", vertices, "--triangles", "50%"}, vertices);
  refuse({"simplify", vertices, "-o", elsewhere + ".ply", "--triangles", "50%", "--report", vertices},
         vertices);
  refuse({"info", vertices, "--self-intersections", vertices}, vertices);
  const std::string field = mesh(d / "field.vti"), body = mesh(d / "1" / "body.npy"),
                    both = mesh(d / "o2" / "map.exr"), line = mesh(d / "frames.jsonl");
  refuse({"volume", field, "--spacing", "0.5", "-o", field}, field);
  refuse({"bodies", box, body, "-o", d, "--resolution", "16"}, body);
  refuse({"map", box, both, "-o", d, "--both", "--write", "exr"}, both);
  refuse({"sequence", box, line, "-o", d, "--resolution", "16"}, line);
  const std::string part = mesh(d / "part.ply"), list = mesh(d / kManifest);
  refuse({"scene", "scan", "--mesh", part, "-o", d}, part);
  refuse({"map", box, list, "-o", d, "--write", "none", "--resolution", "16"}, list);
}

// What a mesh file refers to, and what options name.
TEST_F(InputFiles, AreAlsoThoseThatOthersReferTo) {
  const std::string box = mesh(d / "box.ply", 1);
  const Mesh solid = cube(0.9);
  std::string bytes;
  for (const Vec3& p : solid.positions)
    for (const double x : p) {
      const auto value = static_cast<float>(x);
      bytes.append(reinterpret_cast<const char*>(&value), 4);
    }
  text(d / "map.exr", bytes);
  const std::string model = d / "model.gltf";
  text(model, R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "map.exr", "byteLength": 96}],
    "bufferViews": [{"buffer": 0, "byteLength": 96}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]})");
  expect_refusal({"map", model, box, "-o", d, "--write", "exr", "--resolution", "16"}, d / "map.exr",
                 d / "map.exr");

  const std::string painted = write_obj(d / "painted.obj", solid);
  text(d / "painted.obj", "mtllib report.json\nusemtl m\n" + contents(painted));
  text(d / "report.json", "newmtl m\nKd 1 0 0\n");
  expect_refusal({"bake", painted, box, "-o", d, "--resolution", "16"}, d / "report.json", d / "report.json");

  const Arguments map{"map", box, box, "-o", d, "--write", "none", "--resolution", "16"};
  const auto with = [&](const std::string& option, const std::string& words, const std::string& value) {
    text(d / "report.json", words);
    Arguments arguments = map;
    arguments.insert(arguments.end(), {option, value});
    expect_refusal(arguments, d / "report.json", d / "report.json");
  };
  const std::string named = d / "report.json";
  with("--tolerance-table", "group,lower,upper\ntop,-1,1\n", named);
  with("--transform-o1", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "matrix:" + named);
  with("--align-321", "0 0 0 0 0 0\n1 0 0 1 0 0\n0 1 0 0 1 0\n0 0 1 0 0 1\n1 0 1 1 0 1\n0 1 1 0 1 1\n",
       named);
  text(d / "report.json", "0 0 0 1 0 0 0\n3 0 0 1 0 0 0\n");
  expect_refusal({"bodies", box, box, "-o", d, "--poses", named, "--resolution", "16"}, named, named);

  const fs::path npy = folder / "motion.npy";
  SequenceWriter motion(npy, solid.positions.size());
  motion.add(solid.positions);
  motion.commit();
  fs::create_hard_link(npy, d / "frames.csv");
  const std::string body = mesh(d / "body.ply");
  expect_refusal({"sequence", body + "+" + npy.string(), box, "-o", d, "--resolution", "16"},
                 d / "frames.csv", npy);
}

TEST_F(InputFiles, AreRecognisedByAnyName) {
  const std::string box = mesh(d / "box.ply", 1), part = mesh(folder / "part.ply");
  const fs::path points = d / "points.ply", turned = d / ".." / "d" / ".." / "part.ply";
  const Arguments into_d{"-o", d};
  const auto refuse = [&](const std::string& input) {
    expect_refusal({"points", input, box, "-o", d}, points, input);
    expect_refusal({"points", input, box, "-o", d / ".." / "." / "d"}, points, input);
  };
  fs::create_hard_link(part, points);
  refuse(part);
  refuse(turned);
  fs::remove(points);
  fs::create_symlink(part, points);
  refuse(part);
  refuse(points);
  fs::remove(points);
  fs::rename(part, points);
  fs::create_symlink("d/points.ply", part);
  refuse(part);
  fs::create_directory_symlink(d, folder / "way");
  refuse(folder / "way" / "points.ply");
  expect_refusal({"points", points, box, "-o", folder / "way"}, points, points);
}

/// A lock on the output folder, for which a run waits before it moves its files.
struct LockedFolder {
  explicit LockedFolder(const fs::path& folder)
      : file(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    EXPECT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
  }
  int file;
};

TEST_F(InputFiles, ThatComeToThePlaceOfAnOutputMeanwhileRemain) {
  const std::string box = mesh(d / "box.ply", 1), cloud = mesh(folder / "cloud.ply");
  const std::string bytes = contents(cloud);
  Outcome run;
  {
    const LockedFolder held(d);
    std::jthread thread([&] { run = run_sdm({"points", cloud, box, "-o", d}); });
    const auto is_staged = [&] {  // its last file is written
      for (const std::string& name : names_in(d))
        if (fs::exists(d / name / "files" / "report.json")) return true;
      return false;
    };
    for (int i = 0; i < 6000 && !is_staged(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    fs::rename(cloud, d / "points.ply");
    close(held.file);
  }
  EXPECT_EQ(run.code, 1) << run.out;
  EXPECT_THAT(run.err, HasSubstr("points.ply: it is the input " + cloud));
  EXPECT_EQ(contents(d / "points.ply"), bytes);
  EXPECT_THAT(names_in(d), ::testing::ElementsAre("box.ply", "points.ply"));
}

// A file is sdm's to remove only as it has written it.
TEST_F(InputFiles, OfUsersRemainInOutputFolders) {
  const std::string o1 = mesh(folder / "a.ply"), o2 = mesh(folder / "b.ply", 1);
  text(d / "vertices.csv", "mine");
  text(d / "normal.png", "mine");
  const auto map = [&](const std::string& files) {
    return run_sdm({"map", o1, o2, "-o", d, "--resolution", "16", "--write", files});
  };
  ASSERT_EQ(map("exr,npy,glb,texture").code, 0);
  text(d / "model.glb", "changed");
  fs::rename(d / "map.exr", d / "kept.exr");
  fs::create_symlink("kept.exr", d / "map.exr");
  ASSERT_EQ(map("none").code, 0);
  EXPECT_THAT(names_in(d), ::testing::ElementsAre("kept.exr", "map.exr", "model.glb", "normal.png",
                                                  "report.json", "vertices.csv"));
  EXPECT_EQ(contents(d / "vertices.csv"), "mine");
  EXPECT_EQ(contents(d / "model.glb"), "changed");
  // What one command has written is no result of another.
  ASSERT_EQ(run_sdm({"points", o1, o2, "-o", d, "--write", "ply"}).code, 0);
  ASSERT_EQ(map("npy").code, 0);
  EXPECT_TRUE(fs::exists(d / "points.ply"));
}

TEST_F(InputFiles, OfAnEarlierRunAreNotRemoved) {
  const std::string o1 = mesh(folder / "a.ply"), o2 = mesh(folder / "b.ply", 1), model = d / "model.glb";
  ASSERT_EQ(run_sdm({"map", o1, o2, "-o", d, "--resolution", "16", "--write", "glb"}).code, 0);
  const auto before = all_in(d);
  for (const fs::path& input : {fs::path(model), fs::path(folder / "link.glb")}) {
    if (input != model) fs::create_symlink(model, input);
    const Outcome run = run_sdm({"map", input, o2, "-o", d, "--resolution", "16", "--write", "exr"});
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.err, HasSubstr("cannot remove " + model +
                                   ", which an earlier run has written: it is the input " + input.string()));
    EXPECT_TRUE(all_in(d) == before);
  }
}

// A manifest from a stranger removes nothing outside of the folder.
TEST_F(InputFiles, OutsideOfTheFolderAreNotRemovedByAManifest) {
  const std::string o1 = mesh(folder / "a.ply"), o2 = mesh(folder / "b.ply", 1);
  fs::create_directory(folder / "home");
  const auto run = [&](const std::string& files) {
    return run_sdm({"map", o1, o2, "-o", d, "--resolution", "16", "--write", files}).code;
  };
  ASSERT_EQ(run("exr"), 0);
  nlohmann::json manifest = nlohmann::json::parse(contents(d / kManifest));
  const auto exr =
      std::ranges::find(manifest["files"], "map.exr", [](const auto& file) { return file["path"]; });
  ASSERT_NE(exr, manifest["files"].end());
  nlohmann::json entry = *exr;
  fs::create_directory_symlink(folder / "home", d / "o1");
  const std::vector<std::string> places{"../home/map.exr", folder / "home" / "map.exr", "o1/map.exr"};
  for (const std::string& place : places) {
    entry["path"] = place;
    manifest["files"].push_back(entry);
  }
  manifest["files"].push_back("no object");
  fs::copy_file(d / "map.exr", folder / "home" / "map.exr");
  text(d / kManifest, manifest.dump());
  ASSERT_EQ(run("none"), 0);
  EXPECT_FALSE(fs::exists(d / "map.exr"));
  EXPECT_TRUE(fs::exists(folder / "home" / "map.exr"));
  for (const char* damaged : {"", "{", "[]", R"({"files": 3})", R"({"files": [{"path": 1}]})"}) {
    text(d / kManifest, damaged);
    EXPECT_EQ(run("none"), 0) << damaged;
  }
}

// Input files in the staging folder of a killed run, which the next run would remove.
TEST_F(InputFiles, InAnAbandonedStagingFolderRemain) {
  const fs::path staging = d / ".sdm-part-0123abcd", link = folder / "link.ply";
  const std::string box = mesh(d / "box.ply", 1), part = mesh(staging / "files" / "points.ply");
  text(staging / ".sdm-staging", "");
  fs::create_symlink(part, link);
  for (const fs::path& input : {fs::path(part), link}) {
    EXPECT_EQ(run_sdm({"points", input, box, "-o", d}).code, 0);
    EXPECT_TRUE(fs::exists(part));
  }
}

/// Random command lines, whose inputs have names of outputs, under several names.
class Collisions {
 public:
  explicit Collisions(unsigned seed) : random_(seed) {}

  /// Runs one, and reports what was lost.
  void run() {
    const std::size_t earlier = roll(3);
    if (earlier > 0) run_earlier(earlier == 1);
    a_ = input();
    b_ = input();
    for (std::size_t i = roll(3); i > 0; --i) (void)input();  // files of the user that are not read
    const Arguments arguments = command();
    SCOPED_TRACE(fmt::format("sdm {}", fmt::join(arguments, " ")));
    const auto before = contents_of(read_);
    const auto users = contents_of(users_);
    const Outcome outcome = run_sdm(arguments);
    EXPECT_LE(outcome.code, 5) << outcome.err;
    EXPECT_TRUE(contents_of(read_) == before) << "an input is lost";
    for (const auto& [name, bytes] : contents_of(users_)) EXPECT_FALSE(bytes.empty()) << name << " is lost";
    succeeded = outcome.code != 1;
    conflicted = outcome.err.find("it is the input") != std::string::npos;
    if (outcome.code == 2) {
      EXPECT_THAT(outcome.err, HasSubstr("it names a file of -o"));
    }
    if (earlier == 0) {  // a model is no cloud, and a cloud no mesh
      EXPECT_TRUE(succeeded || conflicted) << outcome.err;
    }
  }

  bool succeeded = false, conflicted = false;

 private:
  std::size_t roll(std::size_t sides) { return random_() % sides; }
  template <class Items>
  auto one_of(const Items& items) {
    return items[roll(items.size())];
  }

  static std::map<std::string, std::string> contents_of(const std::vector<std::string>& files) {
    std::map<std::string, std::string> all;
    for (const std::string& file : files) all[file] = contents(file);
    return all;
  }

  std::string name() {
    static const std::vector<std::string> names{"report.json",
                                                "report.html",
                                                "map.exr",
                                                "model.glb",
                                                "views.png",
                                                "atlas_voronoi.png",
                                                "points.ply",
                                                "baked.glb",
                                                "normal.png",
                                                "vertices.csv",
                                                "vertices.ply",
                                                "vertices.npy",
                                                "frames.jsonl",
                                                "frames.csv",
                                                "plot.png",
                                                "mean.png",
                                                "resume.state",
                                                "scene.json",
                                                "part.ply",
                                                "x.ply",
                                                "x_lod1.ply",
                                                "alignment.json",
                                                "ray.exr",
                                                "0/map.exr",
                                                "1/body.npy",
                                                "o1/map.exr",
                                                "o2/model.glb",
                                                "maps/0000.png",
                                                ".sdm-files.json",
                                                "x.npy",
                                                ".sdm-part-1234abcd/files/points.ply"};
    return one_of(names);
  }

  /// A path in the output folder, in one of several spellings.
  std::string place(const std::string& name) {
    return (one_of(std::vector<fs::path>{d_, d_ / "." / ".." / "d", folder_ / "way"}) / name).string();
  }

  /// A mesh in the output folder, or elsewhere with a link to it in the folder.
  std::string input() {
    fs::path file = d_ / name();
    if (fs::exists(fs::symlink_status(file))) return file;  // also one that an earlier run has written
    if (file.parent_path().filename() == "files" && fs::create_directories(file.parent_path()))
      std::ofstream(file.parent_path().parent_path() / ".sdm-staging");
    fs::create_directories(file.parent_path());
    const fs::path elsewhere = folder_ / fmt::format("{}.ply", ++count_);
    const std::size_t kind = roll(4);
    write_as_ply(kind < 2 ? file : elsewhere, cube(0.8 + 0.01 * static_cast<double>(count_)));
    if (kind == 2) fs::create_hard_link(elsewhere, file);
    if (kind == 3) fs::create_symlink(elsewhere, file);
    // The staging folder of a killed run is not the user's, but a file in it that is named remains.
    if (file.parent_path().filename() != "files") users_.push_back(file);
    if (kind < 2) return place(fs::relative(file, d_));
    users_.push_back(elsewhere);
    return roll(2) == 0 ? elsewhere.string() : file.string();
  }

  /// Leaves results, and perhaps takes them for inputs.
  void run_earlier(bool used) {
    const fs::path one = folder_ / "first.ply", other = folder_ / "second.ply";
    write_mesh(one, cube(0.9));
    write_mesh(other, cube(1));
    const std::vector<Arguments> runs{
        {"map", one, other, "-o", d_, "--resolution", "16", "--write", "glb,ply"},
        {"points", one, other, "-o", d_, "--write", "ply"},
        {"self", one, "-o", d_, "--resolution", "16", "--write", "glb,csv"}};
    EXPECT_EQ(run_sdm(one_of(runs)).code, 0);
    if (!used) return;
    for (const char* mesh : {"model.glb", "vertices.ply"})
      if (fs::exists(d_ / mesh)) a_of_earlier_ = d_ / mesh;
  }

  Arguments command() {
    if (!a_of_earlier_.empty()) a_ = a_of_earlier_;
    const std::string out = place("");
    const std::string file = (d_ / name()).string(), ply = place(one_of(std::vector<std::string>{
                                                         "x.ply", "points.ply", "vertices.ply", "part.ply"}));
    const std::string write =
        one_of(std::vector<std::string>{"none", "exr", "glb,ply", "png,csv", "npy,views"});
    const std::string few = one_of(std::vector<std::string>{"none", "exr", "glb", "png,views"});
    const std::vector<Arguments> commands{
        {"map", a_, b_, "-o", out, "--resolution", "16", "--write", write},
        {"map", a_, b_, "-o", out, "--resolution", "16", "--write", few, "--both"},
        {"map", a_, b_, "-o", out, "--resolution", "16", "--write", few, "--align"},
        {"self", a_, "-o", out, "--resolution", "16", "--write", write},
        {"thickness", a_, "-o", out, "--resolution", "16", "--write", write},
        {"points", a_, b_, "-o", out, "--write", one_of(std::vector<std::string>{"none", "ply"})},
        {"bake", a_, b_, "-o", out, "--resolution", "16", "--channels", "normal", "--no-page"},
        {"bodies", a_, b_, "-o", out, "--resolution", "16", "--write", few},
        {"sequence", a_, b_, "-o", out, "--resolution", "16", "--maps", "1"},
        {"simplify", a_, "-o", ply, "--triangles", "50%", "--lods", "1", "--report", file},
        {"volume", a_, "--spacing", "0.5", "-o",
         place(one_of(std::vector<std::string>{"x.npy", "vertices.npy"}))},
        {"info", a_, "--self-intersections", file},
        {"hausdorff", a_, b_},
        {"scene", "scan", "--mesh", a_, "--triangles", "200", "-o", out}};
    Arguments arguments = one_of(commands);
    for (std::size_t i = 1; i < arguments.size(); ++i) {
      const bool is_output = arguments[i - 1] == "-o" || arguments[i - 1] == "--report" ||
                             arguments[i - 1] == "--self-intersections";
      if (!is_output && (arguments[i] == a_ || arguments[i] == b_)) read_.push_back(arguments[i]);
    }
    // By all their other names, too.
    for (const std::string& user : users_)
      if (std::ranges::any_of(read_, [&](const std::string& read) { return fs::equivalent(read, user); }))
        read_.push_back(user);
    arguments.emplace_back("--quiet");
    if (arguments[0] == "info") arguments.pop_back();
    return arguments;
  }

  std::mt19937 random_;
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path(), d_ = make_d();
  fs::path make_d() const {
    fs::create_directory(temporary_ / "d");
    fs::create_directory_symlink("d", temporary_ / "way");
    return temporary_ / "d";
  }
  std::vector<std::string> read_, users_;  ///< what the run reads, and what was there
  std::string a_, b_, a_of_earlier_;
  int count_ = 0;
};

TEST(RandomCommandLines, LoseNoInput) {
  std::size_t succeeded = 0, conflicted = 0;
  const std::size_t all = subset(25, 1000);
  for (unsigned seed = 0; seed < all; ++seed) {
    SCOPED_TRACE(seed);
    Collisions collisions(seed);
    collisions.run();
    succeeded += collisions.succeeded;
    conflicted += collisions.conflicted;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(succeeded, all / 4);
  EXPECT_GT(conflicted, all / 10);
}

}  // namespace
}  // namespace sdm::test
