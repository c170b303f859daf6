#include "io/write/png.h"

#include <png.h>
#include <sdm/error.h>

#include <csetjmp>
#include <vector>

#include "io/write/deflate.h"

namespace sdm::io {
namespace {

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

// Each returns false if libpng fails: it jumps back into the function, which must own nothing that needs
// destruction.
bool write_header(const PngWriter& writer, std::uint32_t width, std::uint32_t height) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_IHDR(writer.png, writer.info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(writer.png, writer.info);
  return true;
}
bool write_chunk(const PngWriter& writer, const char* name, std::span<const std::uint8_t> bytes) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_write_chunk(writer.png, reinterpret_cast<png_const_bytep>(name), bytes.data(), bytes.size());
  return true;
}

void check(bool written) {
  if (!written) throw Error("libpng failed to encode an image; see its message above");
}

// A row's filter and its bytes. Filter 1 (Sub) stores differences from the pixel to the left.
void filter(std::span<const Rgb> pixels, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  bytes.push_back(PNG_FILTER_VALUE_SUB);
  Rgb left{0, 0, 0};
  for (const Rgb& pixel : pixels) {
    bytes.push_back(static_cast<std::uint8_t>(pixel.r - left.r));
    bytes.push_back(static_cast<std::uint8_t>(pixel.g - left.g));
    bytes.push_back(static_cast<std::uint8_t>(pixel.b - left.b));
    left = pixel;
  }
}

}  // namespace

// libpng writes the chunks; the pixels are filtered and compressed here, as every row has the same filter.
void write_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
               const std::function<void(std::uint32_t, std::span<Rgb>)>& row) {
  const PngWriter writer;
  if (writer.info == nullptr) throw Error("libpng cannot start: not enough memory");
  png_set_write_fn(writer.png, &stream, write_bytes, flush);
  check(write_header(writer, width, height));
  DeflateStream compressed(
      [&](std::span<const std::uint8_t> bytes) { check(write_chunk(writer, "IDAT", bytes)); });
  std::vector<Rgb> pixels(width);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(1 + std::size_t{3} * width);
  for (std::uint32_t y = 0; y < height; ++y) {
    row(y, pixels);
    filter(pixels, bytes);
    compressed.write(bytes);
  }
  compressed.finish();
  check(write_chunk(writer, "IEND", {}));
}

}  // namespace sdm::io
