// Distances of the vertices of a file, read back from every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
std::vector<T> numbers_at(std::string_view bytes, std::size_t offset, std::size_t count) {
  std::vector<T> numbers(count);
  if (offset + count * sizeof(T) > bytes.size()) throw std::out_of_range("the file is too short");
  std::memcpy(numbers.data(), bytes.data() + offset, count * sizeof(T));
  return numbers;
}

std::vector<std::uint32_t> bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> result;
  for (const float value : values) result.push_back(std::bit_cast<std::uint32_t>(value));
  return result;
}

std::string decoded(std::string_view base64) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  for (std::size_t i = 0; i + 3 < base64.size(); i += 4) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k)
      group =
          group << 6 | (base64[i + k] == '=' ? 0 : static_cast<std::uint32_t>(kDigits.find(base64[i + k])));
    for (int shift = 16; shift >= 0; shift -= 8) bytes += static_cast<char>(group >> shift & 0xFF);
    if (base64[i + 3] == '=') break;
  }
  return bytes;
}

// A quad and a triangle, with a vertex of no face, two vertices at one place, and one without a distance.
struct VertexFiles : ::testing::Test {
  TemporaryFolder folder;
  FileVertices vertices{
      .positions = {{0.1, 0, 0}, {1, -0.0, 0}, {1, 1, 1e-300}, {0, 1e30, 0}, {1, 1, 1e-300}, {7, 7, 7}},
      .mesh_vertex = {0, 1, 2, 3, 2, kNone},
      .corners = {0, 1, 2, 3, 1, 4, 3},
      .ends = {4, 7}};
  std::vector<float> distances{0.1f, -2.5e-7f, 3, std::numeric_limits<float>::infinity()};
  std::vector<float> expected{0.1f, -2.5e-7f, 3, kNan, 3, kNan};
};

TEST_F(VertexFiles, OfPlyHaveQualityAndDistance) {
  write_vertices_ply(folder / "a.ply", vertices, distances);
  const std::string bytes = bytes_of(folder / "a.ply");
  EXPECT_THAT(bytes, ::testing::HasSubstr(
                         "element vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
                         "property float quality\nproperty float distance\nelement face 2\n"));
  const std::size_t data = bytes.find("end_header\n") + 11;
  for (std::size_t v = 0; v < 6; ++v) {
    const auto position = numbers_at<double>(bytes, data + 32 * v, 3);
    EXPECT_EQ((Vec3{position[0], position[1], position[2]}), vertices.positions[v]);
    const auto values = numbers_at<float>(bytes, data + 32 * v + 24, 2);
    EXPECT_EQ(bits(values), bits({expected[v], expected[v]}));
  }
  // The reader welds, and drops the vertex without a face.
  const Mesh read = read_mesh(folder / "a.ply");
  EXPECT_EQ(read.triangles.size(), 3u);
  EXPECT_EQ(read.positions.size(), 4u);
}

TEST_F(VertexFiles, OfPlyMayFormPolygonsOfManyCorners) {
  vertices = {};
  for (std::uint32_t v = 0; v < 300; ++v) {
    vertices.positions.push_back({std::cos(v * 0.02), std::sin(v * 0.02), 0});
    vertices.mesh_vertex.push_back(v);
    vertices.corners.push_back(v);
  }
  vertices.ends = {300};
  write_vertices_ply(folder / "a.ply", vertices, std::vector<float>(300, 1.f));
  EXPECT_EQ(read_mesh(folder / "a.ply").triangles.size(), 298u);
}

TEST_F(VertexFiles, OfCsvHaveAllDigits) {
  write_vertices_csv(folder / "a.csv", vertices, distances);
  std::istringstream lines(bytes_of(folder / "a.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "vertex,x,y,z,distance");
  for (std::size_t v = 0; v < 6; ++v) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream fields(line + ",");
    std::vector<std::string> words;
    for (std::string word; std::getline(fields, word, ',');) words.push_back(word);
    ASSERT_EQ(words.size(), 5u) << line;
    EXPECT_EQ(words[0], std::to_string(v));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(std::stod(words[k + 1]), vertices.positions[v][k]);
    if (std::isnan(expected[v])) {
      EXPECT_EQ(words[4], "");
    } else {
      EXPECT_EQ(std::stof(words[4]), expected[v]);
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(VertexFiles, OfNpyAreOneRow) {
  write_vertices_npy(folder / "a.npy", vertices, distances);
  const std::string bytes = bytes_of(folder / "a.npy");
  EXPECT_THAT(bytes, ::testing::HasSubstr("'shape': (6,)"));
  EXPECT_EQ(bits(numbers_at<float>(bytes, 128, 6)), bits(expected));
  EXPECT_EQ(bytes.size(), 128u + 24);
}

TEST_F(VertexFiles, OfVtpAreBlocksOfBase64) {
  write_vertices_vtp(folder / "a.vtp", vertices, distances);
  const std::string text = bytes_of(folder / "a.vtp");
  EXPECT_THAT(text, ::testing::HasSubstr(R"(NumberOfPoints="6")"));
  EXPECT_THAT(text, ::testing::HasSubstr(R"(NumberOfPolys="2")"));
  const std::size_t data = text.find('_', text.find("<AppendedData")) + 1;
  // The bytes of the block of an array, after their count.
  const auto block = [&](const std::string& name) {
    const std::size_t array = text.find("Name=\"" + name), at = text.find("offset=\"", array) + 8;
    std::size_t offset = 0;
    std::from_chars(text.data() + at, text.data() + text.size(), offset);
    const std::string all = decoded(std::string_view(text).substr(data + offset));
    const std::uint64_t count = numbers_at<std::uint64_t>(all, 0, 1)[0];
    return all.substr(8, count);
  };
  EXPECT_EQ(bits(numbers_at<float>(block("distance"), 0, 6)), bits(expected));
  EXPECT_EQ(numbers_at<double>(block("Points"), 0, 18)[11], 0);
  EXPECT_EQ(numbers_at<double>(block("Points"), 0, 18)[10], 1e30);
  EXPECT_EQ(numbers_at<std::int64_t>(block("connectivity"), 0, 7),
            (std::vector<std::int64_t>{0, 1, 2, 3, 1, 4, 3}));
  EXPECT_EQ(numbers_at<std::int64_t>(block("offsets"), 0, 2), (std::vector<std::int64_t>{4, 7}));
}

TEST_F(VertexFiles, OfAnotherMeshAreRefused) {
  distances.pop_back();
  EXPECT_THROW(write_vertices_csv(folder / "a.csv", vertices, distances), Error);
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace sdm::test
