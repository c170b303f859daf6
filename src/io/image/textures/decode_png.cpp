#include <fmt/format.h>
#include <png.h>
#include <sdm/error.h>

#include <csetjmp>
#include <cstring>
#include <string>

#include "io/image/textures/decoders.h"

namespace sdm::io {
namespace {

struct PngReader {
  std::string message;
  std::span<const char> rest;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngReader(std::span<const char> bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
    info = png != nullptr ? png_create_info_struct(png) : nullptr;
    if (info == nullptr) throw Error("libpng cannot start: not enough memory");
    png_set_read_fn(png, this, take);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngReader*>(png_get_error_ptr(png))->message = message;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void take(png_structp png, png_bytep to, std::size_t count) {
    auto& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest;
    if (count > rest.size()) png_error(png, "it is truncated");
    std::memcpy(to, rest.data(), count);
    rest = rest.subspan(count);
  }
};

// libpng jumps back into these functions if it fails. They then return false, and must own nothing that
// needs destruction.
bool read_header(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_user_limits(reader.png, 0x7FFFFFFF, 0x7FFFFFFF);  // checked below
  png_read_info(reader.png, reader.info);
  return true;
}
bool choose_format(PngReader& reader, int& passes) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png);  // palettes, fewer than 8 bits, and transparent colours
  png_set_swap(reader.png);    // 16 bits: the lower byte first
  passes = png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}
bool read_rows(PngReader& reader, Image& image, int passes) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  const std::size_t row_bytes = image.bytes.size() / image.height;
  for (int pass = 0; pass < passes; ++pass)
    for (std::size_t y = 0; y < image.height; ++y)
      png_read_row(reader.png, image.bytes.data() + y * row_bytes, nullptr);
  png_read_end(reader.png, nullptr);
  return true;
}

std::size_t pixels_of(const PngReader& reader) {
  return check_size(png_get_image_width(reader.png, reader.info),
                    png_get_image_height(reader.png, reader.info));
}

}  // namespace

std::size_t pixels_of_png(std::span<const char> bytes) {
  PngReader reader(bytes);
  return read_header(reader) ? pixels_of(reader) : 0;
}

Image decode_png(std::span<const char> bytes) {
  PngReader reader(bytes);
  const auto check = [&](bool read) {
    if (!read) throw Error(fmt::format("the PNG picture cannot be read: {}", reader.message));
  };
  check(read_header(reader));
  (void)pixels_of(reader);
  int passes = 1;
  check(choose_format(reader, passes));
  Image image =
      blank_image(png_get_image_width(reader.png, reader.info), png_get_image_height(reader.png, reader.info),
                  png_get_channels(reader.png, reader.info), png_get_bit_depth(reader.png, reader.info));
  check(read_rows(reader, image, passes));
  return image;
}

}  // namespace sdm::io
