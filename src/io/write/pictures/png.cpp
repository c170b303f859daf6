#include "io/write/pictures/png.h"

#include <png.h>
#include <sdm/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <vector>

#include "core/parallel.h"
#include "io/write/compression/deflate.h"

namespace sdm::io {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Row = std::function<void(std::uint32_t, std::span<Rgb>)>;

static_assert(sizeof(Rgb) == 3, "rows of Rgb are the bytes of the image");

struct PngWriter {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;

  PngWriter() = default;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
};

void write_bytes(png_structp png, png_bytep bytes, size_t count) {
  static_cast<std::ostream*>(png_get_io_ptr(png))
      ->write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
}
void flush(png_structp) {}

// libpng jumps back into these two functions if it fails. They then return false, and must own nothing that
// needs destruction.
bool write_header(const PngWriter& writer, std::uint32_t width, std::uint32_t height) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_IHDR(writer.png, writer.info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(writer.png, writer.info);
  return true;
}
bool write_chunk(const PngWriter& writer, const char* name, const Bytes& bytes) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_write_chunk(writer.png, reinterpret_cast<png_const_bytep>(name), bytes.data(), bytes.size());
  return true;
}
void check(bool written) {
  if (!written) throw Error("libpng failed to encode an image; see its message above");
}

// Consecutive rows, compressed.
struct Strip {
  Bytes bytes;  ///< of a stream of deflate
  uLong checksum = 0;
  std::size_t size = 0;  ///< before compression
};

// Each row as the filter "sub" stores it: its number, 1, and the differences from the pixel before.
Strip compressed(std::uint32_t begin, std::uint32_t end, std::uint32_t width, bool last, const Row& row) {
  std::vector<Rgb> pixels(width);
  Bytes filtered((std::size_t{3} * width + 1) * (end - begin));
  std::uint8_t* to = filtered.data();
  for (std::uint32_t y = begin; y < end; ++y) {
    row(y, pixels);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(pixels.data());
    const std::size_t count = std::size_t{3} * width;
    *to++ = 1;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, count); ++i) to[i] = bytes[i];
    for (std::size_t i = 3; i < count; ++i) to[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - 3]);
    to += count;
  }
  return {deflate_part(filtered, last), adler32_z(1, filtered.data(), filtered.size()), filtered.size()};
}

}  // namespace

void write_png(std::ostream& stream, std::uint32_t width, std::uint32_t height, const Row& row) {
  const PngWriter writer;
  if (writer.info == nullptr) throw Error("libpng cannot start: not enough memory");
  png_set_write_fn(writer.png, &stream, write_bytes, flush);
  check(write_header(writer, width, height));

  constexpr std::size_t kStripBytes = 1 << 18;
  constexpr std::uint32_t kGroup = 8;  // strips in memory
  const auto strip_rows = static_cast<std::uint32_t>(std::max<std::size_t>(1, kStripBytes / (3 * width + 1)));
  const std::uint32_t strips = (height + strip_rows - 1) / strip_rows;
  check(write_chunk(writer, "IDAT", {0x78, 0x01}));  // zlib's header: a window of 32 KiB, fast compression
  uLong checksum = 1;
  std::array<Strip, kGroup> group;
  for (std::uint32_t first = 0; first < strips; first += kGroup) {
    const std::uint32_t count = std::min(kGroup, strips - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto strip = first + static_cast<std::uint32_t>(i);
        group[i] = compressed(strip * strip_rows, std::min(height, (strip + 1) * strip_rows), width,
                              strip + 1 == strips, row);
      }
    });
    for (std::uint32_t i = 0; i < count; ++i) {
      check(write_chunk(writer, "IDAT", group[i].bytes));
      checksum = adler32_combine(checksum, group[i].checksum, static_cast<z_off_t>(group[i].size));
    }
  }
  Bytes end(4);
  for (int i = 0; i < 4; ++i) end[i] = static_cast<std::uint8_t>(checksum >> (24 - 8 * i));
  check(write_chunk(writer, "IDAT", end));
  check(write_chunk(writer, "IEND", {}));
}

}  // namespace sdm::io
