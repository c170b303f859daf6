// Notes on inputs that are probably not in the same units or place, and the digits of places.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr const char* kThousand = "one mesh is about 1000 times the other; millimetres and metres?";
constexpr const char* kInches = "one mesh is about 25.4 times the other; millimetres and inches?";
constexpr const char* kApart = "times their size apart; are both in the same place?";

struct Notes : ::testing::Test {
  TemporaryFolder folder;
  std::string out = folder / "out";

  [[nodiscard]] std::string box(const std::string& name, double scale, const Vec3& offset = {}) const {
    Mesh mesh = cube();
    for (Vec3& p : mesh.positions)
      p = {scale * 30 * p[0] + offset[0], scale * 20 * p[1] + offset[1], scale * 10 * p[2] + offset[2]};
    return write_obj(folder / name, mesh);
  }
  [[nodiscard]] std::string cloud(double scale) const {
    const std::string file = folder / "cloud.xyz";
    std::ofstream(file) << fmt::format("{0} {1} {2}\n-{0} -{1} -{2}\n{0} 0 0\n", 30 * scale, 20 * scale,
                                       10 * scale);
    return file;
  }
  /// Every command of two inputs.
  [[nodiscard]] std::vector<std::vector<std::string>> commands(const std::string& o1,
                                                               const std::string& o2) const {
    return {{"map", o1, o2, "--resolution", "32", "--write", "none", "-o", out},
            {"hausdorff", o1, o2},
            {"metrics", o1, o2},
            {"proximity", o1, o2},
            {"bodies", o1, o2},
            {"sequence", o1, o2, "--resolution", "32", "-o", out}};
  }
  /// The text and the notes of the JSON of a command. Of a sequence, the first line of JSON has them.
  static void expect_notes(std::vector<std::string> command,
                           const ::testing::Matcher<const std::string&>& matcher) {
    SCOPED_TRACE(command[0]);
    const Outcome text = run_sdm(command);
    ASSERT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, matcher);
    command.emplace_back("--json");
    const Outcome run = run_sdm(command);
    ASSERT_EQ(run.code, 0) << run.err;
    const Json json = Json::parse(command[0] == "sequence" ? run.out.substr(0, run.out.find('\n')) : run.out);
    ASSERT_TRUE(json.contains("notes"));
    EXPECT_THAT(json["notes"].dump(), matcher);
    for (const Json& note : json["notes"])
      EXPECT_THAT(text.out, AllOf(HasSubstr("note  "), HasSubstr(note.get<std::string>())));
  }
};

TEST_F(Notes, NameTheUnitsThatSizesSuggestInEveryCommand) {
  const std::string mm = box("mm.obj", 1), metres = box("m.obj", 0.000999),
                    inches = box("inch.obj", 1 / 25.4);
  for (const auto& command : commands(mm, metres)) expect_notes(command, HasSubstr(kThousand));
  for (const auto& command : commands(inches, mm)) expect_notes(command, HasSubstr(kInches));
  const std::vector<std::string> points{"points", cloud(1), metres, "--write", "none", "-o", out};
  expect_notes(points, HasSubstr(kThousand));
}

TEST_F(Notes, AreAbsentWhereSizesAndPlacesAgree) {
  const std::string mm = box("mm.obj", 1), other = box("other.obj", 1.3, {5, 0, 0});
  const auto none = AllOf(Not(HasSubstr("times the other")), Not(HasSubstr("size apart")));
  for (const auto& command : commands(mm, other)) expect_notes(command, none);
  expect_notes({"points", cloud(1), other, "--write", "none", "-o", out}, none);
}

TEST_F(Notes, AUnitThatIsNotKnownIsALabel) {
  const std::string mm = box("mm.obj", 1), other = box("other.obj", 1.3, {5, 0, 0});
  std::vector<std::vector<std::string>> all = commands(mm, other);
  for (const char* command : {"self", "thickness"})
    all.push_back({command, mm, "--resolution", "32", "--write", "none", "-o", out});
  all.push_back({"points", cloud(1), mm, "--write", "none", "-o", out});
  all.push_back({"volume", mm, "--grid", "8", "8", "8", "-o", folder / "field.npy"});
  for (const auto& [unit, matcher] :
       {std::pair<const char*, ::testing::Matcher<const std::string&>>(
            "furlong", HasSubstr("the unit furlong is not known: it is only a label")),
        {"mm", Not(HasSubstr("is not known"))}})
    for (std::vector<std::string> command : all) {
      command.insert(command.end(), {"--units", unit});
      expect_notes(command, matcher);
    }
}

TEST_F(Notes, EveryUnitHasItsTolerance) {
  const std::string mm = box("mm.obj", 1);
  const auto note = [&](double times) {
    const Outcome run = run_sdm({"hausdorff", mm, box("other.obj", times), "--json"});
    const Json notes = Json::parse(run.out)["notes"];
    return notes.empty() ? std::string() : notes[0].get<std::string>();
  };
  EXPECT_THAT(note(10.4), HasSubstr("about 10 times the other; millimetres and centimetres?"));
  EXPECT_THAT(note(1 / 24.3), HasSubstr("about 25.4 times"));
  EXPECT_THAT(note(99), HasSubstr("about 100 times the other; centimetres and metres?"));
  EXPECT_THAT(note(1 / 310.0), HasSubstr("about 304.8 times the other; millimetres and feet?"));
  EXPECT_THAT(note(1040), HasSubstr("millimetres and metres?"));
  EXPECT_THAT(note(5e4), HasSubstr("about 50000 times the other; are both in the same units?"));
  EXPECT_THAT(note(1123), HasSubstr("about 1100 times the other;"));
  EXPECT_THAT(note(2e7), HasSubstr("about 2e+07 times the other;"));
  for (const double times : {1.0, 5.0, 12.0, 20.0, 60.0, 200.0, 500.0}) EXPECT_EQ(note(times), "") << times;
}

TEST_F(Notes, TellOfMeshesThatAreFarApart) {
  const std::string here = box("here.obj", 1), there = box("there.obj", 1, {5e5, 4.5e6, 0});
  for (const auto& command : commands(here, there))
    if (command[0] != "bodies") expect_notes(command, HasSubstr(kApart));
  expect_notes({"bodies", here, there}, HasSubstr("body 0 is more than 100 times its size from all others"));
  expect_notes({"points", cloud(1), there, "--write", "none", "-o", out}, HasSubstr(kApart));
}

// A binary STL of a mesh: its coordinates are rounded to float.
std::string write_stl(const std::filesystem::path& file, const Mesh& mesh) {
  std::ofstream stream(file, std::ios::binary);
  const std::string header(80, ' ');
  stream.write(header.data(), 80);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  stream.write(reinterpret_cast<const char*>(&count), 4);
  for (const Triangle& t : mesh.triangles) {
    std::array<float, 12> values{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k) values[3 + 3 * c + k] = static_cast<float>(mesh.positions[t[c]][k]);
    stream.write(reinterpret_cast<const char*>(values.data()), 48).write("\0", 2);
  }
  return file.string();
}

TEST_F(Notes, TellOfCoordinatesThatAreCoarseForTheSize) {
  const Mesh far = moved(ring(16, 10), {500000.3, 4500000.7, 100});
  const std::string stl = write_stl(folder / "far.stl", far), text = write_obj(folder / "far.obj", far);
  const auto coarse = HasSubstr("coordinates in single precision are 0.5 apart");
  expect_notes({"info", stl}, coarse);
  for (const auto& command : commands(stl, text))
    if (command[0] == "hausdorff" || command[0] == "metrics" || command[0] == "proximity" ||
        command[0] == "bodies")
      expect_notes(command, AllOf(coarse, HasSubstr("far.stl"), Not(HasSubstr("far.obj: coord"))));
  expect_notes({"self", stl, "--resolution", "64", "--write", "none", "-o", out}, coarse);
  expect_notes({"info", text}, Not(HasSubstr("single precision")));
  expect_notes({"info", write_stl(folder / "near.stl", ring(16, 10))}, Not(HasSubstr("single precision")));
  // Of a cloud by its own numbers.
  const std::string cloud = folder / "far.ply";
  {
    std::ofstream stream(cloud, std::ios::binary);
    stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << far.positions.size()
           << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const Vec3& p : far.positions)
      for (const double x : p) {
        const auto rounded = static_cast<float>(x);
        stream.write(reinterpret_cast<const char*>(&rounded), 4);
      }
  }
  expect_notes({"points", cloud, text, "--write", "none", "-o", out}, AllOf(coarse, HasSubstr("far.ply")));
  // The integers of a text file are as they are meant.
  Mesh whole = cube(5);
  for (Vec3& p : whole.positions) p[1] += 4500000;
  expect_notes({"info", write_obj(folder / "whole.obj", whole)}, Not(HasSubstr("single precision")));
}

// In Universal Transverse Mercator coordinates, for example.
TEST_F(Notes, PlacesHaveTheDigitsThatTheSizeOfTheMeshNeeds) {
  const Vec3 utm{500000, 4500000, 0};
  const std::string a = write_obj(folder / "a.obj", moved(cube(5), utm)),
                    b = write_obj(folder / "b.obj", moved(cube(5), {utm[0] + 12.3457, utm[1], 0}));
  EXPECT_THAT(run_sdm({"hausdorff", a, b}).out, HasSubstr("(499995 4499995 -5)"));
  EXPECT_THAT(run_sdm({"proximity", a, b}).out, AllOf(HasSubstr("(500005 "), HasSubstr("(500007.3457 ")));
  EXPECT_THAT(run_sdm({"info", b}).out, HasSubstr("500007.3457  4499995  -5"));
  const std::vector<std::string> map{"map", a, b, "--resolution", "64", "--tolerance", "1", "-o", out};
  EXPECT_THAT(run_sdm(map).out,
              ContainsRegex("at (texel|vertex) \\(499995 4(499995|50000[0-5])(\\.[0-9]+)? "));
  const std::string cloud = folder / "utm.xyz";
  std::ofstream(cloud) << "500000.1234 4500000.25 20\n500000 4500000 5\n";
  EXPECT_THAT(run_sdm({"points", cloud, a, "--tolerance", "1", "-o", out}).out,
              HasSubstr("at point 0 (500000.1234 4500000.25 20)"));
}

}  // namespace
}  // namespace sdm::test
