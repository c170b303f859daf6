// Matrices from files.
#include <gmock/gmock.h>
#include <sdm/mesh_files.h>

#include <bit>
#include <fstream>
#include <string>

#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct MatrixFile : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path file = folder / "pose";

  std::filesystem::path with(const std::string& contents) const {
    std::ofstream(file, std::ios::binary) << contents;
    return file;
  }
  std::string fault_of(const std::string& contents) const {
    return error_of([&] { return read_matrix(with(contents)); });
  }
};

const Transform kExpected{{{{1, 2, 3, 4}, {0, 5, 6, 7.5}, {0, 0, -8, 1e-3}, {0, 0, 0, 1}}}};

std::string npy_matrix(const std::string& type, const std::string& order, const std::string& shape,
                       const std::string& data) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header + data;
}

template <class Number>
std::string bytes_of(const Transform& t, bool by_columns, bool swapped = false) {
  std::string bytes;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(
          static_cast<Number>(by_columns ? t.rows[j][i] : t.rows[i][j]));
      if (swapped) std::ranges::reverse(raw);
      bytes.append(raw.data(), raw.size());
    }
  return bytes;
}

TEST_F(MatrixFile, AsText) {
  for (const char* text :
       {"1 2 3 4\n0 5 6 7.5\n0 0 -8 1e-3\n0 0 0 1\n", "1,2,3,4,0,5,6,7.5,0,0,-8,+0.001,0,0,0,1",
        "\xEF\xBB\xBF\x31 2 3 4 0 5 6 7.5 0 0 -8 1e-3 0 0 0 1",
        "# a pose\r\n[[1;2;3;4]\r\n [0;5;6;7.5] # second\r\n [0;0;-8;1E-3]\r\n [0;0;-0;1]]"})
    EXPECT_EQ(read_matrix(with(text)).rows, kExpected.rows) << text;
}

TEST_F(MatrixFile, AsNpy) {
  EXPECT_EQ(read_matrix(with(npy_matrix("<f8", "False", "(4, 4)", bytes_of<double>(kExpected, false)))).rows,
            kExpected.rows);
  EXPECT_EQ(read_matrix(with(npy_matrix("<f8", "True", "(4, 4)", bytes_of<double>(kExpected, true)))).rows,
            kExpected.rows);
  EXPECT_EQ(
      read_matrix(with(npy_matrix(">f8", "False", "(4, 4)", bytes_of<double>(kExpected, false, true)))).rows,
      kExpected.rows);
  EXPECT_EQ(
      read_matrix(with(npy_matrix("<f4", "False", "(4, 4)", bytes_of<float>(kExpected, false)))).rows[2][3],
      1e-3f);
}

TEST_F(MatrixFile, AsJson) {
  const std::string rows = R"("matrix": [[1, 2, 3, 4], [0, 5, 6, 7.5], [0, 0, -8, 0.001], [0, 0, 0, 1]])";
  EXPECT_EQ(read_matrix(with("{" + rows + "}")).rows, kExpected.rows);
  EXPECT_EQ(read_matrix(with("\n{\"version\": 1, \"alignment\": {" + rows + "}}")).rows, kExpected.rows);
}

TEST_F(MatrixFile, FaultsAreOneSentenceThatNamesTheFile) {
  const auto refused = [&](const std::string& contents, const char* fault) {
    const std::string message = fault_of(contents);
    EXPECT_THAT(message, AllOf(HasSubstr(file.string() + ": "), HasSubstr(fault)));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const std::string rest = "0 5 6 7\n0 0 8 1\n0 0 0 1\n";
  refused("", "is empty");
  refused("1 2 3\n0 5 6\n0 0 8\n", "has 9 numbers, not 16");
  refused("1 2 3 4\n" + rest + "1", "has 17 numbers, not 16");
  refused("1 2 3 x\n" + rest, "'x' is not a number");
  refused("1 2 3 \x01\x02\n" + rest, "'\\u0001\\u0002' is not a number");
  refused("1 2 3 nan\n" + rest, "infinite or NaN");
  refused("1 2 inf 4\n" + rest, "infinite or NaN");
  refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n", "the translation is the last column");
  refused("1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n", "singular");
  refused(npy_matrix("<f8", "False", "(3, 4)", ""), "has the shape (3, 4)");
  refused(npy_matrix("<f8", "False", "(4, 4)", "short"), "truncated");
  refused(npy_matrix("<i8", "False", "(4, 4)", std::string(128, 'x')), "'<i8'");
  refused("{", "invalid JSON");
  refused(std::string("1\0 \0\x32\0 \0\x33\0 \0", 12), "this is UTF-16 text; save it as UTF-8");
  refused("{\"rows\": []}", "\"matrix\"");
  refused("{\"matrix\": \"none\"}", "does not consist of numbers");
  refused("{\"matrix\": [[1, null]]}", "does not consist of numbers");
  refused("{\"matrix\": [[1, 2]]}", "has 2 numbers, not 16");
  std::filesystem::remove(file);
  EXPECT_THAT(error_of([&] { return read_matrix(file); }), HasSubstr("there is no such file"));
  EXPECT_THAT(error_of([&] { return read_matrix(folder.path()); }), HasSubstr("this is a folder"));
}

}  // namespace
}  // namespace sdm
