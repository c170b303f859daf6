#include "io/image/pictures/png.h"

#include <png.h>
#include <sdm/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "io/file/deflate.h"

namespace sdm::io {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The bytes of the pixels of row y, as the file stores them.
using Row = std::function<void(std::uint32_t y, std::span<std::uint8_t> bytes)>;

struct Format {
  int color_type, bit_depth;
  std::uint32_t pixel_bytes;
  bool srgb;  // numbers have no colour space
};
constexpr Format kColours{PNG_COLOR_TYPE_RGB, 8, 3, true}, kGrey{PNG_COLOR_TYPE_GRAY, 16, 2, false};

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
bool write_header(const PngWriter& writer, std::uint32_t width, std::uint32_t height, const Format& format) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_IHDR(writer.png, writer.info, width, height, format.bit_depth, format.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (format.srgb) png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
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

// Each row as the filter "sub" stores it: its number, 1, and the differences from the pixel before, byte by
// byte.
Strip compressed(std::uint32_t begin, std::uint32_t end, std::size_t row_bytes, std::size_t pixel_bytes,
                 bool last, const Row& row) {
  Bytes bytes(row_bytes), filtered((row_bytes + 1) * (end - begin));
  std::uint8_t* to = filtered.data();
  for (std::uint32_t y = begin; y < end; ++y) {
    row(y, bytes);
    *to++ = 1;
    for (std::size_t i = 0; i < std::min(pixel_bytes, row_bytes); ++i) to[i] = bytes[i];
    for (std::size_t i = pixel_bytes; i < row_bytes; ++i)
      to[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - pixel_bytes]);
    to += row_bytes;
  }
  return {deflate_part(filtered, last), adler32_z(1, filtered.data(), filtered.size()), filtered.size()};
}

void write(std::ostream& stream, std::uint32_t width, std::uint32_t height, const Format& format,
           const Row& row) {
  const PngWriter writer;
  if (writer.info == nullptr) throw Error("libpng cannot start: not enough memory");
  png_set_write_fn(writer.png, &stream, write_bytes, flush);
  check(write_header(writer, width, height, format));

  const std::size_t row_bytes = std::size_t{format.pixel_bytes} * width;
  constexpr std::size_t kStripBytes = 1 << 18;
  constexpr std::uint32_t kGroup = 8;  // strips in memory
  const auto strip_rows = static_cast<std::uint32_t>(std::max<std::size_t>(1, kStripBytes / (row_bytes + 1)));
  const std::uint32_t strips = (height + strip_rows - 1) / strip_rows;
  check(write_chunk(writer, "IDAT", {0x78, 0x01}));  // zlib's header: a window of 32 KiB, fast compression
  uLong checksum = 1;
  std::array<Strip, kGroup> group;
  for (std::uint32_t first = 0; first < strips; first += kGroup) {
    const std::uint32_t count = std::min(kGroup, strips - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto strip = first + static_cast<std::uint32_t>(i);
        group[i] = compressed(strip * strip_rows, std::min(height, (strip + 1) * strip_rows), row_bytes,
                              format.pixel_bytes, strip + 1 == strips, row);
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

}  // namespace

void write_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
               const std::function<void(std::uint32_t, std::span<Rgb>)>& row) {
  write(stream, width, height, kColours, [&](std::uint32_t y, std::span<std::uint8_t> bytes) {
    row(y, {reinterpret_cast<Rgb*>(bytes.data()), width});
  });
}

void write_image_png(std::ostream& stream, const Image& image, bool srgb) {
  constexpr int kTypes[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                            PNG_COLOR_TYPE_RGB_ALPHA};
  const std::uint32_t pixel_bytes = image.components * image.bits / 8;
  const Format format{kTypes[image.components - 1], static_cast<int>(image.bits), pixel_bytes,
                      srgb && image.components >= 3};
  const std::size_t row_bytes = std::size_t{pixel_bytes} * image.width;
  write(stream, image.width, image.height, format, [&](std::uint32_t y, std::span<std::uint8_t> bytes) {
    std::copy_n(&image.bytes[y * row_bytes], row_bytes, bytes.begin());
    if (image.bits == 16)  // the more significant byte first
      for (std::size_t i = 0; i < row_bytes; i += 2) std::swap(bytes[i], bytes[i + 1]);
  });
}

void write_gray_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
                    const std::function<void(std::uint32_t, std::span<std::uint16_t>)>& row) {
  write(stream, width, height, kGrey, [&](std::uint32_t y, std::span<std::uint8_t> bytes) {
    std::vector<std::uint16_t> values(width);
    row(y, values);
    for (std::size_t x = 0; x < width; ++x) {  // the more significant byte first
      bytes[2 * x] = static_cast<std::uint8_t>(values[x] >> 8);
      bytes[2 * x + 1] = static_cast<std::uint8_t>(values[x]);
    }
  });
}

}  // namespace sdm::io
