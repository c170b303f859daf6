// Sequences of positions in an NPY file, for the vertices of a mesh file.
#include <fcntl.h>
#include <fmt/format.h>
#include <sdm/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include "core/memory.h"
#include "io/file/byte_scanner.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/file/npy_header.h"
#include "io/mesh/frames/frame_source.h"
#include "io/mesh/read_polygons.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// A regular file with random access.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(const fs::path& file)
      : descriptor_(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) {
      const int fault = errno;
      if (descriptor_ >= 0) close(descriptor_);
      throw Error(fmt::format("cannot be opened: {}", std::generic_category().message(fault)));
    }
    if (!S_ISREG(status.st_mode)) {
      close(descriptor_);
      throw Error("this is not a regular file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~RandomAccessFile() { close(descriptor_); }
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  void read(std::uint64_t begin, char* bytes, std::size_t count) const {
    while (count > 0) {
      const ssize_t got = pread(descriptor_, bytes, count, static_cast<off_t>(begin));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0)
        throw Error(fmt::format("cannot be read: {}", got == 0 ? "it became shorter while it was being read"
                                                               : std::generic_category().message(errno)));
      bytes += got, begin += static_cast<std::uint64_t>(got), count -= static_cast<std::size_t>(got);
    }
  }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

class NpyFrames : public FrameSource {
 public:
  NpyFrames(fs::path mesh, fs::path npy)
      : mesh_name_(std::move(mesh)), npy_name_(std::move(npy)), file_(npy_name_), header_(read_header()) {}

  PolygonMesh take_polygons() override {
    PolygonMesh polygons = with_error_prefix(
        polygons_name(), [&] { return read_polygons(read_bytes(mesh_name_).view(), mesh_name_); });
    with_error_prefix(npy_name_.string(), [&] { check_shape(polygons.positions.size()); });
    require_memory(header_.shape[1] * 3 * header_.number_bytes, "a frame");
    bytes_.resize(header_.shape[1] * 3 * header_.number_bytes);
    return polygons;
  }

  std::string polygons_name() const override { return mesh_name_.string(); }
  std::size_t count() const override { return header_.shape[0]; }

  std::string name(std::size_t frame) const override {
    return fmt::format("frame {} of {}", frame, npy_name_.filename().string());
  }
  std::vector<fs::path> files() const override { return {mesh_name_, npy_name_}; }

  void read(std::size_t frame, std::vector<Vec3>& positions) override {
    if (header_.fortran_order)
      read_strided(frame);
    else
      file_.read(header_.data_begin + frame * bytes_.size(), bytes_.data(), bytes_.size());
    positions.resize(header_.shape[1]);
    const char* at = bytes_.data();
    for (Vec3& p : positions)
      for (double& x : p) {
        x = header_.number_bytes == 4 ? load<float>(at, header_.order) : load<double>(at, header_.order);
        at += header_.number_bytes;
      }
  }

 private:
  NpyHeader read_header() const {
    std::string begin(std::min<std::uint64_t>(file_.size(), kMaxNpyHeader), '\0');
    file_.read(0, begin.data(), begin.size());
    return parse_npy_header(begin);
  }

  void check_shape(std::size_t vertices) const {
    const std::vector<std::uint64_t>& shape = header_.shape;
    if (shape.size() != 3 || shape[2] != 3)
      throw Error(fmt::format("has the shape ({}); positions must have the shape (frames, vertices, 3)",
                              fmt::join(shape, ", ")));
    if (shape[0] == 0 || shape[1] == 0)
      throw Error(fmt::format("has the shape ({}), which holds no positions", fmt::join(shape, ", ")));
    if (shape[1] != vertices)
      throw Error(fmt::format("has {} vertices per frame, but {} has {}", shape[1],
                              mesh_name_.filename().string(), vertices));
    // The file size bounds the number of frames, so nothing below can overflow.
    const std::uint64_t frame_bytes = std::uint64_t{vertices} * 3 * header_.number_bytes;
    const std::uint64_t data = file_.size() - header_.data_begin;
    if (data % frame_bytes != 0 || data / frame_bytes != shape[0])
      throw Error(
          fmt::format("has {} bytes of numbers, but the header declares {} frames of {} bytes; it is "
                      "truncated or damaged",
                      data, shape[0], frame_bytes));
  }

  // Reads Fortran order, where element (t, v, k) has the index t + T·(v + V·k).
  void read_strided(std::size_t frame) {
    const std::uint64_t frames = header_.shape[0], vertices = header_.shape[1], size = header_.number_bytes;
    for (std::uint64_t k = 0; k < 3; ++k)
      for (std::uint64_t v = 0; v < vertices; ++v)
        file_.read(header_.data_begin + (frame + frames * (v + vertices * k)) * size,
                   bytes_.data() + (3 * v + k) * size, size);
  }

  fs::path mesh_name_, npy_name_;
  RandomAccessFile file_;
  NpyHeader header_;
  std::vector<char> bytes_;  // of one frame, in C order
};

}  // namespace

std::unique_ptr<FrameSource> npy_frames(const fs::path& mesh, const fs::path& npy) {
  return with_error_prefix(npy.string(), [&] { return std::make_unique<NpyFrames>(mesh, npy); });
}

}  // namespace sdm::io
