// Sequences of positions in an NPY file, for the vertices of a mesh file.
#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "core/cancellation.h"
#include "core/memory.h"
#include "io/file/byte_scanner.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/file/npy.h"
#include "io/mesh/frames/frame_source.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// A regular file with random access, without a buffer: what is read is large.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(const fs::path& file) {
    require_regular_file(file, "NPY");
    stream_.rdbuf()->pubsetbuf(nullptr, 0);
    errno = 0;
    stream_.open(file, std::ios::binary);
    if (!stream_) fail("opened");
    size_ = fs::file_size(file);
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  void read(std::uint64_t begin, char* bytes, std::size_t count) {
    errno = 0;
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(begin));
    if (stream_.read(bytes, static_cast<std::streamsize>(count))) return;
    if (stream_.eof()) throw Error("cannot be read: it became shorter while it was being read");
    fail("read");
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw Error(fmt::format("cannot be {}: {}", what, std::generic_category().message(errno)));
  }

  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

class NpyFrames : public FrameSource {
 public:
  NpyFrames(fs::path mesh, fs::path npy, const TessellationOptions& tessellation)
      : FrameSource(tessellation),
        mesh_name_(std::move(mesh)),
        npy_name_(std::move(npy)),
        file_(npy_name_),
        header_(read_header()) {}

  PolygonMesh take_polygons() override {
    PolygonMesh polygons = with_error_prefix(polygons_name(), [&] { return read_file(mesh_name_); });
    with_error_prefix(npy_name_.string(), [&] { check_shape(polygons.positions.size()); });
    frame_bytes_ = header_.shape[1] * 3 * header_.number_bytes;
    most_frames_ = header_.fortran_order ? frames_of_block() : 1;
    require_memory(most_frames_ * frame_bytes_, "a frame");
    bytes_.resize(most_frames_ * frame_bytes_);
    return polygons;
  }

  std::string polygons_name() const override { return mesh_name_.string(); }
  std::size_t count() const override { return header_.shape[0]; }

  std::string name(std::size_t frame) const override {
    return fmt::format("frame {} of {}", frame, npy_name_.filename().string());
  }
  std::vector<fs::path> files() const override { return {mesh_name_, npy_name_}; }

  void read(std::size_t frame, std::vector<Vec3>& positions) override {
    if (frame - first_ >= frames_) read_block(frame);
    positions.resize(header_.shape[1]);
    const char* at = bytes_.data() + (frame - first_) * frame_bytes_;
    for (Vec3& p : positions)
      for (double& x : p) {
        x = header_.number_bytes == 4 ? load<float>(at, header_.order) : load<double>(at, header_.order);
        at += header_.number_bytes;
      }
  }

 private:
  NpyHeader read_header() {
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

  // The numbers of a frame in Fortran order are spread over the whole file, which is read once for many
  // frames.
  [[nodiscard]] std::uint64_t frames_of_block() const {
    constexpr std::uint64_t kMostBytes = 64 << 20;
    return std::clamp<std::uint64_t>(kMostBytes / frame_bytes_, 1, header_.shape[0]);
  }

  void read_block(std::uint64_t first) {
    frames_ = 0;  // in case of an error
    const std::uint64_t count = std::min(most_frames_, header_.shape[0] - first);
    if (header_.fortran_order)
      read_columns(first, count);
    else
      file_.read(header_.data_begin + first * frame_bytes_, bytes_.data(), frame_bytes_);
    first_ = first;
    frames_ = count;
  }

  // Reads Fortran order, where element (t, v, k) has the index t + T·(v + V·k), a run of columns (v, k) at a
  // time: from the first frame of its first column to the last frame of its last one.
  void read_columns(std::uint64_t first, std::uint64_t count) {
    constexpr std::uint64_t kRun = 1 << 20;  // bytes
    const std::uint64_t vertices = header_.shape[1], size = header_.number_bytes;
    const std::uint64_t column_bytes = header_.shape[0] * size, columns = 3 * vertices;
    const std::uint64_t most = std::max<std::uint64_t>(1, kRun / column_bytes);
    for (std::uint64_t begin = 0; begin < columns; begin += most) {
      poll();
      const std::uint64_t run = std::min(most, columns - begin);
      run_.resize((run - 1) * column_bytes + count * size);
      file_.read(header_.data_begin + begin * column_bytes + first * size, run_.data(), run_.size());
      for (std::uint64_t c = 0; c < run; ++c) {
        const std::uint64_t v = (begin + c) % vertices, k = (begin + c) / vertices;
        char* to = bytes_.data() + (3 * v + k) * size;
        const char* from = run_.data() + c * column_bytes;
        for (std::uint64_t t = 0; t < count; ++t) std::memcpy(to + t * frame_bytes_, from + t * size, size);
      }
    }
  }

  fs::path mesh_name_, npy_name_;
  RandomAccessFile file_;
  NpyHeader header_;
  std::uint64_t frame_bytes_ = 0, most_frames_ = 0;
  std::vector<char> bytes_;               // of consecutive frames, in C order
  std::uint64_t first_ = 0, frames_ = 0;  // of those
  std::vector<char> run_;
};

}  // namespace

std::unique_ptr<FrameSource> npy_frames(const fs::path& mesh, const fs::path& npy,
                                        const TessellationOptions& tessellation) {
  return with_error_prefix(npy.string(),
                           [&] { return std::make_unique<NpyFrames>(mesh, npy, tessellation); });
}

}  // namespace sdm::io
