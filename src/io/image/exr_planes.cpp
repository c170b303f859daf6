#include "io/image/exr_planes.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/version.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>

#include "core/parallel.h"
#include "io/file/atomic_file.h"
#include "io/file/deflate.h"

namespace sdm::io {
namespace {

// OpenEXR's number of rows in a chunk of a file compressed with ZIP.
constexpr std::uint32_t kRowsPerChunk = 16;

// A file that is written in chunks. Chunks are compressed by the caller, by all threads at once: OpenEXR's
// own compression with zlib takes twice as long.
class ExrFile {
 public:
  ExrFile(const std::filesystem::path& file, std::uint32_t columns, std::uint32_t rows,
          std::span<const ExrPlane> planes, const ExrText& text)
      : file_(file), name_(file.string()) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = this;
    settings.error_handler_fn = take_message;
    settings.write_fn = write;
    check(exr_start_write(&context_, name_.c_str(), EXR_WRITE_FILE_DIRECTLY, &settings));
    try {
      write_header(static_cast<std::int32_t>(columns), static_cast<std::int32_t>(rows), planes, text);
    } catch (...) {
      exr_finish(&context_);
      throw;
    }
  }
  ~ExrFile() { exr_finish(&context_); }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  // Chunks must come in the order of their rows.
  void write_chunk(std::uint32_t first_row, std::span<const std::uint8_t> bytes) {
    check(exr_write_scanline_chunk(context_, 0, static_cast<int>(first_row), bytes.data(), bytes.size()));
  }
  void commit() {
    check(exr_finish(&context_));
    file_.commit();
  }

 private:
  void write_header(std::int32_t columns, std::int32_t rows, std::span<const ExrPlane> planes,
                    const ExrText& text) {
    int part = 0;
    check(exr_add_part(context_, nullptr, EXR_STORAGE_SCANLINE, &part));
    check(exr_initialize_required_attr_simple(context_, part, columns, rows, EXR_COMPRESSION_ZIP));
    for (const ExrPlane& plane : planes)
      check(exr_add_channel(context_, part, plane.name.c_str(),
                            plane.whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1,
                            1));
    const std::string comment = fmt::format("{}, sdm {}", text.title, kVersion);
    check(exr_attr_set_string(context_, part, "comments", comment.c_str()));
    for (const auto& [name, value] : text.attributes)
      check(exr_attr_set_string(context_, part, name.c_str(), value.c_str()));
    check(exr_write_header(context_));
  }

  void check(exr_result_t result) const {
    if (result == EXR_ERR_SUCCESS) return;
    if (result == EXR_ERR_OUT_OF_MEMORY) throw std::bad_alloc();
    file_.check();
    throw Error("cannot write " + name_ + ": " +
                (message_.empty() ? exr_get_default_error_message(result) : message_));
  }

  // The library is C, through which no exception may pass.
  static void take_message(exr_const_context_t context, exr_result_t, const char* message) try {
    void* self = nullptr;
    if (exr_get_user_data(context, &self) == EXR_ERR_SUCCESS) static_cast<ExrFile*>(self)->message_ = message;
  } catch (...) {
  }
  static std::int64_t write(exr_const_context_t, void* self, const void* bytes, std::uint64_t count,
                            std::uint64_t offset, exr_stream_error_func_ptr_t) try {
    std::ostream& stream = static_cast<ExrFile*>(self)->file_.stream();
    if (static_cast<std::uint64_t>(stream.tellp()) != offset)
      stream.seekp(static_cast<std::streamoff>(offset));
    stream.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    return stream ? static_cast<std::int64_t>(count) : -1;
  } catch (...) {
    return -1;
  }

  AtomicFile file_;
  std::string name_, message_;
  exr_context_t context_ = nullptr;
};

// What OpenEXR's ZIP compresses: all even bytes of the values, then all odd ones, each as its difference from
// the byte before, plus 128.
std::unique_ptr<std::uint8_t[]> differences(std::span<const std::uint32_t> values) {
  const std::size_t half = 2 * values.size();
  const auto split = std::make_unique_for_overwrite<std::uint8_t[]>(2 * half);
  auto result = std::make_unique_for_overwrite<std::uint8_t[]>(2 * half);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = std::bit_cast<std::array<std::uint8_t, 4>>(values[i]);
    split[2 * i] = value[0];
    split[2 * i + 1] = value[2];
    split[half + 2 * i] = value[1];
    split[half + 2 * i + 1] = value[3];
  }
  result[0] = split[0];
  for (std::size_t i = 1; i < 2 * half; ++i)
    result[i] = static_cast<std::uint8_t>(split[i] - split[i - 1] + 128);
  return result;
}

// A chunk as it is stored: compressed, or as it is if it would not get smaller.
std::vector<std::uint8_t> packed(std::span<const std::uint32_t> values) {
  std::vector<std::uint8_t> bytes = zlib_compressed({differences(values).get(), values.size_bytes()});
  if (bytes.empty()) {
    bytes.resize(values.size_bytes());
    std::memcpy(bytes.data(), values.data(), bytes.size());
  }
  return bytes;
}

}  // namespace

void write_planes(const std::filesystem::path& file, std::uint32_t columns, std::uint32_t rows,
                  std::span<const ExrPlane> planes, const ExrText& text, const ReadRow& read) {
  static_assert(std::endian::native == std::endian::little, "the order of bytes in the file");
  ExrFile exr(file, columns, rows, planes, text);
  const auto chunk = [&](std::uint32_t first_row) {
    const std::uint32_t count = std::min(kRowsPerChunk, rows - first_row);
    const std::size_t of_row = planes.size() * columns;
    const auto values = std::make_unique_for_overwrite<std::uint32_t[]>(of_row * count);
    for (std::uint32_t y = 0; y < count; ++y) read(first_row + y, {&values[y * of_row], of_row});
    return packed({values.get(), of_row * count});
  };
  // Groups of chunks, so that memory does not grow with the number of rows.
  constexpr std::uint32_t kGroup = 16;
  const std::uint32_t chunks = (rows + kRowsPerChunk - 1) / kRowsPerChunk;
  std::array<std::vector<std::uint8_t>, kGroup> group;
  for (std::uint32_t first = 0; first < chunks; first += kGroup) {
    const std::uint32_t count = std::min(kGroup, chunks - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        group[i] = chunk((first + static_cast<std::uint32_t>(i)) * kRowsPerChunk);
    });
    for (std::uint32_t i = 0; i < count; ++i) exr.write_chunk((first + i) * kRowsPerChunk, group[i]);
  }
  exr.commit();
}

}  // namespace sdm::io
