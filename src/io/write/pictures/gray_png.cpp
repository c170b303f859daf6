#include "io/write/pictures/gray_png.h"

#include <png.h>
#include <sdm/error.h>

#include <bit>
#include <csetjmp>
#include <vector>

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

// Returns false if libpng fails: it jumps back into this function, which must own nothing that needs
// destruction.
bool encode(const PngWriter& writer, std::uint32_t width, std::uint32_t height,
            std::vector<std::uint16_t>& pixels,
            const std::function<void(std::uint32_t, std::span<std::uint16_t>)>& row) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_IHDR(writer.png, writer.info, width, height, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(writer.png, 1);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_write_info(writer.png, writer.info);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(writer.png);
  for (std::uint32_t y = 0; y < height; ++y) {
    row(y, pixels);
    png_write_row(writer.png, reinterpret_cast<png_const_bytep>(pixels.data()));
  }
  png_write_end(writer.png, nullptr);
  return true;
}

}  // namespace

void write_gray_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
                    const std::function<void(std::uint32_t, std::span<std::uint16_t>)>& row) {
  const PngWriter writer;
  if (writer.info == nullptr) throw Error("libpng cannot start: not enough memory");
  png_set_write_fn(writer.png, &stream, write_bytes, flush);
  std::vector<std::uint16_t> pixels(width);
  if (!encode(writer, width, height, pixels, row))
    throw Error("libpng failed to encode an image; see its message above");
}

}  // namespace sdm::io
