// Round trips of meshes, sequences and values per texel.
#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <fstream>
#include <vector>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(WriteMesh, PlyKeepsEveryBit) {
  const TemporaryFolder folder;
  const Mesh mesh = ring(12, 0.1, {1.0 / 3, 1e-30, 1e3});
  write_mesh(folder / "torus.ply", mesh);
  const Mesh read = read_mesh(folder / "torus.ply");
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_THROW(write_mesh(folder / "no" / "torus.ply", mesh), Error);
}

TEST(WriteNpy, HasOneNumberPerTexel) {
  const TemporaryFolder folder;
  const std::vector<std::uint32_t> values{0, 1, 0xFFFFFFFF, 258};
  write_npy(folder / "body.npy", 2, values);
  std::ifstream in(folder / "body.npy", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(bytes, HasSubstr("{'descr': '<u4', 'fortran_order': False, 'shape': (2, 2), } "));
  ASSERT_EQ(bytes.size(), 128u + 16);
  EXPECT_EQ(bytes.substr(128), std::string("\0\0\0\0\1\0\0\0\xff\xff\xff\xff\2\1\0\0", 16));
  EXPECT_THROW(write_npy(folder / "body.npy", 3, values), Error);
  EXPECT_THROW(write_npy(folder / "no" / "body.npy", 2, values), Error);
}

struct Motion : ::testing::Test {
  TemporaryFolder folder;
  Mesh mesh = ring(12);
  std::filesystem::path file = folder / "motion.npy";
};

TEST_F(Motion, FramesRoundTripInSinglePrecision) {
  write_mesh(folder / "torus.ply", mesh);
  SequenceWriter writer(file, mesh.positions.size());
  for (int t = 0; t < 12; ++t) {
    for (Vec3& p : mesh.positions) p[0] *= 1.1;
    writer.add(mesh.positions);
  }
  writer.commit();
  MeshSequence read((folder / "torus.ply").string() + "+" + file.string());
  ASSERT_EQ(read.frame_count(), 12u);
  EXPECT_EQ(read.mesh().triangles, mesh.triangles);
  const auto last = read.positions(11);
  for (std::size_t v = 0; v < last.size(); ++v)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(last[v][k], static_cast<double>(static_cast<float>(mesh.positions[v][k])));
}

// NumPy maps files whose numbers begin at a multiple of 64.
TEST_F(Motion, HeadersMatchNumPy) {
  SequenceWriter writer(file, mesh.positions.size());
  writer.add(mesh.positions);
  writer.commit();
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(bytes.size(), 128 + mesh.positions.size() * 12);
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\1\0\x76\0", 10));
  EXPECT_THAT(bytes.substr(10, 118),
              HasSubstr("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 144, 3), } "));
  EXPECT_EQ(bytes[127], '\n');
}

TEST_F(Motion, FileAppearsOnlyWhenComplete) {
  {
    SequenceWriter writer(file, mesh.positions.size());
    writer.add(mesh.positions);
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_TRUE(folder.empty());
}

TEST_F(Motion, ErrorsNameTheFault) {
  SequenceWriter writer(file, mesh.positions.size());
  writer.add(mesh.positions);
  EXPECT_THAT([&] { writer.add(std::span(mesh.positions).first(3)); },
              ThrowsMessage<Error>(HasSubstr("frame 1 has 3 positions for 144 vertices")));
  for (const double x : {std::nan(""), 1e39}) {
    mesh.positions[5][1] = x;
    EXPECT_THAT([&] { writer.add(mesh.positions); }, ThrowsMessage<Error>(HasSubstr("frame 1: vertex 5")));
  }
  EXPECT_THROW(SequenceWriter(folder / "no" / "motion.npy", 1), Error);
}

}  // namespace
}  // namespace sdm::test
