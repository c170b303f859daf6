// Sequences of mesh files, one for each frame.
#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <utility>

#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/mesh/frames/frame_source.h"
#include "io/mesh/frames/numbered_files.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

class SingleFile : public FrameSource {
 public:
  SingleFile(fs::path file, const TessellationOptions& tessellation)
      : FrameSource(tessellation), file_(std::move(file)) {}

  PolygonMesh take_polygons() override {
    PolygonMesh polygons = read_file(file_);
    positions_ = polygons.positions;
    return polygons;
  }
  std::size_t count() const override { return 1; }
  std::string name(std::size_t) const override { return file_.filename().string(); }
  std::vector<fs::path> files() const override { return {file_}; }
  void read(std::size_t, std::vector<Vec3>& positions) override { positions = positions_; }

 private:
  fs::path file_;
  std::vector<Vec3> positions_;
};

class FileFrames : public FrameSource {
 public:
  FileFrames(NumberedFiles files, const TessellationOptions& tessellation)
      : FrameSource(tessellation), files_(std::move(files)) {}

  PolygonMesh take_polygons() override {
    PolygonMesh polygons = with_error_prefix(polygons_name(), [&] { return read_file(files_.file(0)); });
    vertices_ = polygons.positions.size();
    corners_ = polygons.corners;
    ends_ = polygons.ends;
    return polygons;
  }

  std::string polygons_name() const override { return name(0); }
  std::size_t count() const override { return files_.count(); }

  std::string name(std::size_t frame) const override {
    const fs::path file = files_.file(frame);
    return file.empty() ? fmt::format("number {}", files_.number(frame)) : file.filename().string();
  }

  std::vector<fs::path> files() const override {
    std::vector<fs::path> files;
    for (std::size_t i = 0; i < files_.count(); ++i)
      if (fs::path file = files_.file(i); !file.empty()) files.push_back(std::move(file));
    return files;
  }

  bool has_polygons() const override { return true; }
  PolygonMesh polygons_of(std::size_t frame) override {
    const fs::path file = files_.file(frame);
    if (file.empty()) throw Error("there is no file with that number");
    return read_file(file);
  }

  void read(std::size_t frame, std::vector<Vec3>& positions) override {
    PolygonMesh polygons = polygons_of(frame);
    require_same_faces(polygons);
    positions = std::move(polygons.positions);
  }

 private:
  void require_same_faces(const PolygonMesh& polygons) const {
    const auto require_count = [](std::size_t count, std::size_t expected, const char* things) {
      if (count != expected)
        throw Error(fmt::format("has {} {}, and the first frame has {}; all frames need the same number",
                                count, things, expected));
    };
    require_count(polygons.positions.size(), vertices_, "vertices");
    require_count(polygons.ends.size(), ends_.size(), "faces");
    std::size_t begin = 0;
    for (std::size_t f = 0; f < ends_.size(); begin = ends_[f++]) {
      const auto first = static_cast<std::ptrdiff_t>(begin), last = static_cast<std::ptrdiff_t>(ends_[f]);
      if (polygons.ends[f] != ends_[f] ||
          !std::equal(corners_.begin() + first, corners_.begin() + last, polygons.corners.begin() + first))
        throw Error(fmt::format(
            "face {} has other vertices than in the first frame; all frames need the same faces", f));
    }
  }

  NumberedFiles files_;
  std::size_t vertices_ = 0;
  std::vector<std::uint32_t> corners_, ends_;
};

}  // namespace

PolygonMesh FrameSource::read_file(const fs::path& file) {
  PolygonMesh polygons = read_polygons(read_bytes(file).view(), file, options_);
  tessellation_ = polygons.tessellation;
  return polygons;
}

std::unique_ptr<FrameSource> numbered_files_in(const fs::path& folder,
                                               const TessellationOptions& tessellation) {
  return std::make_unique<FileFrames>(NumberedFiles::in(folder), tessellation);
}

std::unique_ptr<FrameSource> numbered_files_like(const fs::path& pattern,
                                                 const TessellationOptions& tessellation) {
  return std::make_unique<FileFrames>(NumberedFiles::like(pattern), tessellation);
}

std::unique_ptr<FrameSource> single_file(const fs::path& file, const TessellationOptions& tessellation) {
  return std::make_unique<SingleFile>(file, tessellation);
}

}  // namespace sdm::io
