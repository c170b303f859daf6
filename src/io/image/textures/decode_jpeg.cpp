#include <fmt/format.h>
#include <sdm/error.h>

#include <array>
#include <csetjmp>
#include <cstdio>  // IWYU pragma: keep, jpeglib.h needs it

#include <jerror.h>
#include <jpeglib.h>

#include "io/image/textures/decoders.h"

namespace sdm::io {
namespace {

struct JpegReader {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf failed{};
  std::array<char, JMSG_LENGTH_MAX> message{};

  JpegReader() {
    jpeg.err = jpeg_std_error(&errors);
    jpeg.client_data = this;
    errors.error_exit = fail;
    errors.emit_message = [](j_common_ptr common, int level) {
      // Where data are damaged or missing, the picture would be filled with grey. Harmless are bytes between
      // parts, and versions of headers.
      const int code = common->err->msg_code;
      if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR && code != JWRN_ADOBE_XFORM)
        fail(common);
    };
    errors.output_message = [](j_common_ptr) {};
  }
  ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

 private:
  [[noreturn]] static void fail(j_common_ptr common) {
    auto& self = *static_cast<JpegReader*>(common->client_data);
    common->err->format_message(common, self.message.data());
    std::longjmp(self.failed, 1);
  }
};

// libjpeg jumps back into these two functions if it fails. They then return false, and must own nothing that
// needs destruction.
bool read_header(JpegReader& reader, std::span<const char> bytes) {
  if (setjmp(reader.failed) != 0) return false;
  jpeg_create_decompress(&reader.jpeg);
  jpeg_mem_src(&reader.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&reader.jpeg, TRUE);
  if (reader.jpeg.jpeg_color_space == JCS_CMYK || reader.jpeg.jpeg_color_space == JCS_YCCK)
    reader.jpeg.out_color_space = JCS_CMYK;
  else
    reader.jpeg.out_color_space = reader.jpeg.jpeg_color_space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_calc_output_dimensions(&reader.jpeg);
  return true;
}
bool read_rows(JpegReader& reader, PromisedMemory& coefficients, std::uint8_t* pixels,
               std::size_t row_bytes) {
  if (setjmp(reader.failed) != 0) return false;
  jpeg_start_decompress(&reader.jpeg);  // reads the coefficients
  coefficients.release();
  while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
    JSAMPROW row = pixels + reader.jpeg.output_scanline * row_bytes;
    jpeg_read_scanlines(&reader.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&reader.jpeg);
  return true;
}

// What libjpeg keeps of a file whose parts are each of the whole picture: all coefficients.
std::size_t coefficient_bytes(const jpeg_decompress_struct& jpeg) {
  if (jpeg_has_multiple_scans(const_cast<jpeg_decompress_struct*>(&jpeg)) == FALSE) return 0;
  std::size_t blocks = 0;
  for (const jpeg_component_info& component : std::span(jpeg.comp_info, jpeg.num_components))
    blocks += std::size_t{component.width_in_blocks} * component.height_in_blocks;
  return blocks * sizeof(JBLOCK);
}

// CMYK without a profile: light passes the inks one after another. Files of Adobe's programs, which are
// nearly all, store the light that each ink lets through.
Image without_inks(const Image& cmyk, bool inverted) {
  Image rgb = blank_image(cmyk.width, cmyk.height, 3, 8);
  const auto through = [&](std::size_t i) -> unsigned {
    return inverted ? cmyk.bytes[i] : 255u - cmyk.bytes[i];
  };
  for (std::size_t i = 0; i < std::size_t{cmyk.width} * cmyk.height; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      rgb.bytes[3 * i + k] = static_cast<std::uint8_t>((through(4 * i + k) * through(4 * i + 3) + 127) / 255);
  return rgb;
}

}  // namespace

std::size_t pixels_of_jpeg(std::span<const char> bytes) {
  JpegReader reader;
  return read_header(reader, bytes) ? check_size(reader.jpeg.output_width, reader.jpeg.output_height) : 0;
}

Image decode_jpeg(std::span<const char> bytes) {
  JpegReader reader;
  const auto check = [&](bool read) {
    if (!read) throw Error(fmt::format("the JPEG picture cannot be read: {}", reader.message.data()));
  };
  check(read_header(reader, bytes));
  check_size(reader.jpeg.output_width, reader.jpeg.output_height);
  PromisedMemory coefficients(coefficient_bytes(reader.jpeg));
  Image image = blank_image(reader.jpeg.output_width, reader.jpeg.output_height,
                            static_cast<std::uint32_t>(reader.jpeg.output_components), 8);
  check(read_rows(reader, coefficients, image.bytes.data(), image.bytes.size() / image.height));
  if (reader.jpeg.out_color_space == JCS_CMYK) return without_inks(image, reader.jpeg.saw_Adobe_marker != 0);
  return image;
}

}  // namespace sdm::io
