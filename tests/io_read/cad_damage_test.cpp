// Damaged CAD files are read or refused, whatever OpenCASCADE makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::string whole_part(const std::string& name) {
  std::ifstream in(std::string(SDM_CAD_FILES) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// Numbers below a limit, the same everywhere.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  std::size_t operator()(std::size_t limit) { return limit == 0 ? 0 : random_() % limit; }

 private:
  std::mt19937 random_;
};

/// The places of `#` and a digit: references of STEP.
std::vector<std::size_t> references(const std::string& text) {
  std::vector<std::size_t> found;
  for (std::size_t at = text.find("DATA;"); at < text.size(); at = text.find('#', at + 1))
    if (text[at] == '#') found.push_back(at + 1);
  return found;
}

std::string number_at(const std::string& text, std::size_t at) {
  return text.substr(at, text.find_first_not_of("0123456789", at) - at);
}

/// Changes bytes, exchanges references, or removes lines; never the first or last lines.
std::string damaged(std::string text, unsigned seed) {
  Dice dice(seed);
  const std::size_t first = text.size() / 8, last = text.size() - 200;
  for (std::size_t left = 1 + dice(4); left > 0; --left) {
    const std::size_t at = first + dice(last - first);
    const std::vector<std::size_t> numbers = references(text);
    if (const std::size_t kind = dice(3); kind == 0) {
      text[at] = static_cast<char>(text[at] ^ (1 << dice(7)));
    } else if (kind == 1 && !numbers.empty()) {
      const std::string other = number_at(text, numbers[dice(numbers.size())]);
      const std::size_t place = numbers[dice(numbers.size())];
      text.replace(place, number_at(text, place).size(), other);
    } else if (const std::size_t begin = text.find('\n', at), end = text.find('\n', begin + 1); end < last) {
      text.erase(begin, end - begin);
    }
  }
  return text;
}

TEST(CadDamage, EveryFileIsReadOrRefused) {
  const TemporaryFolder folder;
  std::size_t refused = 0, read = 0;
  for (const char* name : {"box.step", "tube.step", "assembly.step", "tube.igs"}) {
    const std::string file = folder / name, whole = whole_part(name);
    for (unsigned seed = 0; seed < 15; ++seed) {
      std::ofstream(file, std::ios::binary) << damaged(whole, seed);
      try {
        EXPECT_FALSE(read_mesh(file).triangles.empty()) << name << " " << seed;
        ++read;
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(std::string(name) + ": ")) << seed;
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 10u);
  EXPECT_GT(read, 10u);
}

// OpenCASCADE follows a null pointer.
TEST(CadDamage, ACrashIsAnError) {
  const TemporaryFolder folder;
  const std::string file = folder / "bad.step";
  std::string text = whole_part("box.step");
  replace_all(text, "FACE_BOUND", "FACE_BUNND");
  std::ofstream(file, std::ios::binary) << text;
  const std::string error = error_of([&] { (void)read_mesh(file); });
  EXPECT_THAT(error, HasSubstr("bad.step: OpenCASCADE cannot read it; it is damaged"));
  EXPECT_FALSE(read_mesh(std::string(SDM_CAD_FILES) + "/box.step").triangles.empty());
}

const std::vector<std::string>& names_of(const MeshFile& file, const std::string& kind) {
  return std::ranges::find(file.names, kind, &FaceNames::kind)->names;
}

/// A file with the entities that are added to a part.
void write_with(const std::string& file, std::string text, const std::string& entities) {
  text.insert(text.rfind("ENDSEC;"), entities);
  std::ofstream(file, std::ios::binary) << text;
}

// OpenCASCADE's reader of the names of faces goes round representations that refer to each other until its
// stack ends, and follows a null pointer where one has no items.
TEST(CadDamage, NamesOfFacesAreReadWhateverRepresentationsReferTo) {
  const TemporaryFolder folder;
  const std::string file = folder / "related.step";
  std::string text = whole_part("assembly.step");
  const std::size_t at = text.find("ADVANCED_BREP_SHAPE_REPRESENTATION"), number = text.rfind('#', at) + 1;
  ASSERT_LT(at, text.size());
  const std::string part = "#" + number_at(text, number),
                    placement = "#" + number_at(text, text.find("(#", at) + 2),
                    context = "#" + number_at(text, text.find("),#", at) + 3);
  const std::string other = "#9001 = SHAPE_REPRESENTATION('',(" + placement + ")," + context + ");\n";
  const auto relation = [](const char* id, const std::string& a, const std::string& b) {
    return std::string(id) + " = SHAPE_REPRESENTATION_RELATIONSHIP('',''," + a + "," + b + ");\n";
  };
  const std::string there = relation("#9002", part, "#9001"), back = relation("#9003", "#9001", part);
  const std::string empty = "#9001 = SHAPE_REPRESENTATION('',()," + context + ");\n";
  const MeshFile plain = read_mesh_file(std::string(SDM_CAD_FILES) + "/assembly.step");
  EXPECT_THAT(names_of(plain, "face"), Contains("datum A"));
  for (const std::string& entities : {other + there + back, empty + there}) {
    write_with(file, text, entities);
    const MeshFile read = read_mesh_file(file);
    EXPECT_EQ(read.mesh.triangles.size(), plain.mesh.triangles.size());
    for (const char* kind : {"object", "face", "color"})
      EXPECT_EQ(names_of(read, kind), names_of(plain, kind)) << kind;
    EXPECT_EQ(read.notes, plain.notes) << entities;
  }
}

// OpenCASCADE follows the reference to the style, which is optional.
TEST(CadDamage, ShapesAreReadWithoutNamesAndColoursThatMakeItCrash) {
  const TemporaryFolder folder;
  const std::string file = folder / "styles.step";
  std::string text = whole_part("assembly.step");
  const std::size_t at = text.find("SURFACE_STYLE_USAGE(.BOTH.,#"), style = text.find('#', at),
                    end = text.find(')', at);
  ASSERT_LT(at, text.size());
  std::ofstream(file, std::ios::binary) << text.replace(style, end - style, "$");
  const MeshFile read = read_mesh_file(file),
                 plain = read_mesh_file(std::string(SDM_CAD_FILES) + "/assembly.step");
  EXPECT_EQ(read.mesh.triangles, plain.mesh.triangles);
  EXPECT_EQ(read.mesh.positions, plain.mesh.positions);
  EXPECT_THAT(read.notes,
              Contains("OpenCASCADE fails on the names of its parts, or on its colours: both are left out"));
  EXPECT_THAT(names_of(read, "face"), Contains("datum A"));
}

// The plane of a face has a point in place of its normal.
TEST(CadDamage, MissingFacesAreCountedOnce) {
  const TemporaryFolder folder;
  const std::string file = folder / "five.step";
  std::string text = whole_part("box.step");
  const std::size_t plane = text.find(" PLANE("), point = text.find(",#", text.find("3D(", plane)),
                    normal = text.find(",#", point + 1), end = text.find(",#", normal + 1);
  ASSERT_LT(end, text.size());
  text.replace(normal, end - normal, text.substr(point, normal - point));
  std::ofstream(file, std::ios::binary) << text;
  const MeshFile read = read_mesh_file(file);
  EXPECT_EQ(read.tessellation->faces, 6u);
  EXPECT_EQ(read.tessellation->omitted_faces, 1u);
  EXPECT_THAT(read.notes, Contains(HasSubstr("1 of 6 faces could not be tessellated")));
}

// Triangles as fine as these take a minute.
TEST(CadDamage, ReadingIsCancelled) {
  std::atomic<bool> cancelled = false;
  std::jthread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    cancelled = true;
  });
  const CancelScope scope(cancelled);
  const MeshFileOptions fine{.tessellation = {.deflection = 1e-4}};
  EXPECT_THROW((void)read_mesh_file(std::string(SDM_CAD_FILES) + "/sphere.step", fine), Cancelled);
}

TEST(CadDamage, FilesAreReadByManyThreads) {
  std::atomic<int> good = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      const Mesh mesh = read_mesh(std::string(SDM_CAD_FILES) + "/box.step");
      if (mesh.triangles.size() == 12) ++good;
    });
  threads.clear();
  EXPECT_EQ(good, 4);
}

}  // namespace
}  // namespace sdm::test
