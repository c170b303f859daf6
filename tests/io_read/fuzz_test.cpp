// Any input gives a valid mesh, sequence, point cloud or matrix, or an sdm::Error, within a budget of memory
// and time.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <ostream>
#include <random>
#include <vector>

#include "io_read/input_budget.h"
#include "io_read/try_read.h"
#include "io_read/writers.h"

namespace sdm {
namespace {

using namespace test;

struct Seed {
  std::string name, contents;

  [[nodiscard]] std::string format() const { return name.substr(name.rfind('.') + 1); }
};

std::ostream& operator<<(std::ostream& out, const Seed& seed) {
  return out << seed.name;
}

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The files from which the fuzzers start, too.
std::vector<Seed> seeds() {
  std::vector<Seed> result;
  for (const auto& entry : std::filesystem::directory_iterator(SDM_FUZZ_FOLDER "/corpus"))
    result.push_back({entry.path().filename(), contents_of(entry.path())});
  std::ranges::sort(result, {}, &Seed::name);
  return result;
}

// The words of a format: those of the fuzzer's dictionary, "..." with \", \\ and \xHH; none if it has none.
std::vector<std::string> words_of(const std::string& format) {
  const std::string text = contents_of(SDM_FUZZ_FOLDER "/" + format + ".dict");
  std::vector<std::string> words;
  bool in_word = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '#' && !in_word) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text[i] == '"') {
      in_word = !in_word;
      if (in_word) words.emplace_back();
    } else if (in_word && text[i] == '\\' && text[i + 1] == 'x') {
      words.back() += static_cast<char>(std::stoi(text.substr(i + 2, 2), nullptr, 16));
      i += 3;
    } else if (in_word) {
      words.back() += text[i] == '\\' ? text[++i] : text[i];
    }
  }
  return words;
}

bool try_read(const Seed& seed) {
  const std::filesystem::path file = write_file(seed.name, seed.contents);
  bool is_read = false;
  const InputCost cost = cost_of([&] { is_read = test::try_read(file); });
  EXPECT_LT(cost.bytes, kInputBudget.bytes) << seed.name << ": " << ::testing::PrintToString(seed.contents);
  EXPECT_LT(cost.seconds, kInputBudget.seconds)
      << seed.name << ": " << ::testing::PrintToString(seed.contents);
  return is_read;
}

class Mutator {
 public:
  explicit Mutator(const Seed& seed) : words_(words_of(seed.format())) {
    words_.insert(words_.end(), {"999999999", "-1", "nan", "1e300", "\n", " ", "\\\n", "{", "]", "/", ",",
                                 ";", "\t", "\"", "\r", "#"});
    std::seed_seq numbers(seed.name.begin(), seed.name.end());
    random_.seed(numbers);
  }

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
          s.insert(at, words_[below(words_.size())]);
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
  std::vector<std::string> words_;
  std::mt19937 random_;
};

// What a file asks for counts, even where the system refuses it.
TEST(InputBudget, CountsMemoryAndProcessorTime) {
  const std::size_t much = kInputBudget.bytes;
  EXPECT_GE(cost_of([&] { std::vector<char>{}.reserve(much); }).bytes, much);
  EXPECT_GE(cost_of([&] { EXPECT_THROW(std::vector<char>{}.reserve(64 * much), std::bad_alloc); }).bytes,
            64 * much);
  EXPECT_LT(cost_of([] {}).bytes, 1000u);
  volatile double x = 1;
  EXPECT_GT(cost_of([&] {
              for (int i = 0; i < 1000000; ++i) x = x * 1.000001;
            }).seconds,
            0);
}

class Fuzz : public ::testing::TestWithParam<Seed> {};

TEST_P(Fuzz, MutatedFile) {
  constexpr std::size_t kInputs = 10000;  // of each format
  const Seed& seed = GetParam();
  Mutator mutator(seed);
  const std::vector<Seed> all = seeds();
  const std::size_t of_format = static_cast<std::size_t>(
      std::ranges::count_if(all, [&](const Seed& other) { return other.format() == seed.format(); }));
  ASSERT_TRUE(try_read(seed));
  const std::size_t rounds = kInputs / of_format + 1;
  std::size_t refused = 0;
  for (std::size_t round = 0; round < rounds && !HasFailure(); ++round) {
    Seed mutated = seed;
    mutator.mutate(mutated.contents);
    refused += !try_read(mutated);
  }
  EXPECT_GT(refused, rounds / 30);  // mutations damage files
  EXPECT_LT(refused, rounds);       // but not always
}

// The least length of a cut that cannot be detected: OBJ and text clouds have no end, PTS and PTX end after
// any scan, that of STL text may be missing, and text may be cut within its last number or after its last
// face.
std::size_t shortest_whole(const Seed& seed) {
  const std::string& all = seed.contents;
  const std::string format = seed.format();
  for (const char* without_end : {"obj", "xyz", "csv", "pts", "ptx"})
    if (format == without_end) return 0;
  if (seed.name == "a.stl" || seed.name == "c.stl")
    return std::min(all.find("endloop"), all.find("end loop")) + 7;
  if (seed.name == "d.stl") return 84 + 50;  // its count is unknown
  if (format == "off" || seed.name == "a.ply" || seed.name == "d.ply" || seed.name == "a.pcd" ||
      seed.name == "a.matrix")
    return all.rfind(' ');
  return all.size();
}

TEST_P(Fuzz, FileCutAtEveryLength) {
  const Seed& seed = GetParam();
  for (std::size_t length = 0; length < seed.contents.size(); ++length) {
    const bool is_read = try_read({seed.name, seed.contents.substr(0, length)});
    EXPECT_FALSE(is_read && length < shortest_whole(seed)) << "cut at " << length;
  }
}

// A test for each file, so that they run at the same time.
INSTANTIATE_TEST_SUITE_P(Corpus, Fuzz, ::testing::ValuesIn(seeds()), [](const auto& test) {
  std::string name = test.param.name;
  std::ranges::replace(name, '.', '_');
  return name;
});

}  // namespace
}  // namespace sdm
