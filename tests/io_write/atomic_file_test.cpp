
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <vector>

#include "support/made_up_maps.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using Writer = std::function<void(const std::filesystem::path&)>;

struct AllWriters : ::testing::Test {
  const Field field = [](const Vec3& p) { return p[0]; };
  const Surface surface{ring(8), {.kind = AtlasKind::triangles, .resolution = 256}};
  const DistanceMap map = map_of(surface, field);
  const std::vector<float> vertices = at_vertices(surface.mesh(), field);
  const std::vector<Writer> writers{
      [this](const auto& file) { write_exr(file, surface, map); },
      [this](const auto& file) { write_distance_png(file, surface, map); },
      [this](const auto& file) { write_voronoi_png(file, surface, map); },
      [this](const auto& file) { write_direction_png(file, surface, map); },
      [this](const auto& file) { write_glb(file, surface, map, vertices); },
  };
  TemporaryFolder folder;
};

/// During its lifetime no file can grow beyond `bytes`: writing fails as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(AllWriters, LeaveNoFilesOnAFullDisk) {
  for (std::size_t i = 0; i < writers.size(); ++i)
    for (const rlim_t bytes : {0, 100, 1500, 4000}) {
      const FileSizeLimit limit(bytes);
      try {
        writers[i](folder / "result");
        FAIL() << "writer " << i << " wrote more than " << bytes << " bytes";
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr((folder / "result").string()));
        EXPECT_THAT(error.what(), ::testing::HasSubstr("File too large"));
      }
      EXPECT_TRUE(folder.empty()) << i << ", " << bytes;
    }
}

TEST_F(AllWriters, ReplaceAnExistingFileOnlyOnSuccess) {
  for (const Writer& write : writers) {
    const auto file = folder / "result";
    std::ofstream(file) << "earlier";
    {
      const FileSizeLimit limit(1000);
      EXPECT_THROW(write(file), Error);
    }
    EXPECT_EQ(contents(file), "earlier");
    write(file);
    EXPECT_GT(contents(file).size(), 1000u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  }
}

TEST_F(AllWriters, RejectMissingFoldersAndFoldersAsFiles) {
  std::filesystem::create_directory(folder / "taken");
  for (const Writer& write : writers) {
    EXPECT_THROW(write(folder / "missing/result"), Error);
    EXPECT_THROW(write(folder / "taken"), Error);
  }
  EXPECT_THROW(writers[0]("/dev/full"), Error);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace sdm::test
