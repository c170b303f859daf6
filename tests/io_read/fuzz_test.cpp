// Any input gives a valid mesh, sequence, point cloud or matrix, or an sdm::Error.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "io_read/try_read.h"
#include "io_read/writers.h"

namespace sdm {
namespace {

using namespace test;

struct Seed {
  std::string name, contents;
};

// The files from which the fuzzers start, too.
std::vector<Seed> seeds() {
  std::vector<Seed> result;
  for (const auto& entry : std::filesystem::directory_iterator(SDM_FUZZ_CORPUS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    result.push_back({entry.path().filename(), {std::istreambuf_iterator<char>(file), {}}});
  }
  std::ranges::sort(result, {}, &Seed::name);
  return result;
}

bool try_read(const Seed& seed) {
  return test::try_read(write_file(seed.name, seed.contents));
}

class Mutator {
 public:
  void mutate(std::string& s) {
    for (std::size_t edits = 1 + below(4); edits > 0 && !s.empty(); --edits) {
      const std::size_t at = below(s.size()), length = 1 + below(std::min<std::size_t>(16, s.size() - at));
      switch (below(8)) {
        case 0:  // a bit
          s[at] = static_cast<char>(s[at] ^ 1 << below(8));
          break;
        case 1:  // any byte
          s[at] = static_cast<char>(below(256));
          break;
        case 2:  // a digit or a sign
          s[at] = "0123456789-+.e"[below(14)];
          break;
        case 3:
          s.erase(at, length);
          break;
        case 4:
          s.insert(at, s.substr(below(s.size()), length));
          break;
        case 5:
          s.insert(
              at, std::array{"999999999", "-1", "nan", "1e300", "\n", " ", "\\\n", "{", "]", "/"}[below(10)]);
          break;
        case 6:  // an extreme number of 16 or 32 bits
          s.replace(at, std::min<std::size_t>(length > 8 ? 4 : 2, s.size() - at), length > 8 ? 4 : 2,
                    below(2) ? '\xFF' : '\x7F');
          break;
        default:
          if (below(8) == 0) s.resize(at);
      }
    }
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }
  std::mt19937 random_{12345};
};

TEST(Fuzz, MutatedFiles) {
  Mutator mutator;
  ASSERT_EQ(seeds().size(), 25u);
  for (const Seed& seed : seeds()) {
    ASSERT_TRUE(try_read(seed)) << seed.name;
    std::size_t refused = 0;
    for (int round = 0; round < 3000; ++round) {
      Seed mutated = seed;
      mutator.mutate(mutated.contents);
      refused += !try_read(mutated);
    }
    EXPECT_GT(refused, 100u) << seed.name;   // mutations damage files
    EXPECT_LT(refused, 3000u) << seed.name;  // but not always
  }
}

// The least length of a cut that cannot be detected: OBJ and XYZ have no end, and text may be cut within its
// last number or after its last face.
std::size_t shortest_whole(const Seed& seed) {
  if (seed.name == "a.obj" || seed.name.ends_with(".xyz")) return 0;
  if (seed.name == "a.stl") return seed.contents.rfind("endsolid") + 8;
  if (seed.name.ends_with(".off") || seed.name == "a.ply" || seed.name == "a.pcd" || seed.name == "a.matrix")
    return seed.contents.rfind(' ');
  return seed.contents.size();
}

TEST(Fuzz, FilesCutAtEveryLength) {
  for (const Seed& seed : seeds())
    for (std::size_t length = 0; length < seed.contents.size(); ++length) {
      const bool is_read = try_read({seed.name, seed.contents.substr(0, length)});
      EXPECT_FALSE(is_read && length < shortest_whole(seed)) << seed.name << " cut at " << length;
    }
}

}  // namespace
}  // namespace sdm
