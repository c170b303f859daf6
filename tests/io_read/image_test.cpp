// Pictures, as encoders other than the code under test write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <webp/encode.h>
#include <zlib.h>

#include <cstdint>
#include <cstdio>  // IWYU pragma: keep, jpeglib.h needs it
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <jpeglib.h>

#include "io_read/writers.h"
#include "support/error_of.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::uint32_t kWidth = 23, kHeight = 17;

/// Smooth, so that lossy formats keep it: component c of n, from 0 to `most`.
std::uint32_t expected(std::uint32_t x, std::uint32_t y, std::uint32_t c, std::uint32_t most) {
  const std::uint32_t steps = kWidth + kHeight;
  return most *
         (c == 0   ? x + y
          : c == 1 ? x + kHeight - y
          : c == 2 ? kWidth - x + y
                   : steps - y) /
         (2 * steps);
}

struct PngOptions {
  int color_type = PNG_COLOR_TYPE_RGB, bits = 8;
  int interlace = PNG_INTERLACE_NONE;
  bool transparent = false;  // of palettes: colour i has the opacity 255 - i
};

std::string png(const PngOptions& options) {
  std::string file;
  png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(writer);
  png_set_write_fn(
      writer, &file,
      [](png_structp p, png_bytep bytes, std::size_t count) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(bytes), count);
      },
      nullptr);
  png_set_IHDR(writer, info, kWidth, kHeight, options.bits, options.color_type, options.interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette(256);
  for (std::uint32_t i = 0; i < 256; ++i)
    palette[i] = {static_cast<png_byte>(i), static_cast<png_byte>(255 - i), 7};
  if (options.color_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(writer, info, palette.data(), 256);
  std::vector<png_byte> opacities(256);
  for (std::uint32_t i = 0; i < 256; ++i) opacities[i] = static_cast<png_byte>(255 - i);
  if (options.transparent) png_set_tRNS(writer, info, opacities.data(), 256, nullptr);
  png_set_gAMA(writer, info, 1.0);  // to be ignored
  png_write_info(writer, info);
  const std::uint32_t channels = png_get_channels(writer, info);
  std::vector<std::string> rows(kHeight);
  std::vector<png_bytep> pointers;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (std::uint32_t c = 0; c < channels; ++c) {
        if (options.bits == 16)
          put(rows[y], static_cast<std::uint16_t>(expected(x, y, c, 65535)), std::endian::big);
        else
          put(rows[y], static_cast<std::uint8_t>(expected(x, y, c, 255)));
      }
    pointers.push_back(reinterpret_cast<png_bytep>(rows[y].data()));
  }
  png_write_image(writer, pointers.data());
  png_write_end(writer, nullptr);
  png_destroy_write_struct(&writer, &info);
  return file;
}

struct JpegOptions {
  bool progressive = false, adobe = true;
};

std::string jpeg(J_COLOR_SPACE space, int components, const JpegOptions& options = {}) {
  jpeg_compress_struct writer{};
  jpeg_error_mgr errors{};
  writer.err = jpeg_std_error(&errors);
  jpeg_create_compress(&writer);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&writer, &bytes, &size);
  writer.image_width = kWidth;
  writer.image_height = kHeight;
  writer.input_components = components;
  writer.in_color_space = space;
  jpeg_set_defaults(&writer);
  jpeg_set_quality(&writer, 100, TRUE);
  for (int c = 0; c < components; ++c)
    writer.comp_info[c].h_samp_factor = writer.comp_info[c].v_samp_factor = 1;
  if (options.progressive) jpeg_simple_progression(&writer);
  if (!options.adobe) writer.write_Adobe_marker = FALSE;
  jpeg_start_compress(&writer, TRUE);
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    std::vector<JSAMPLE> row;
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (int c = 0; c < components; ++c)
        row.push_back(static_cast<JSAMPLE>(expected(x, y, static_cast<std::uint32_t>(c), 255)));
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&writer, &pointer, 1);
  }
  jpeg_finish_compress(&writer);
  jpeg_destroy_compress(&writer);
  std::string file(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return file;
}

std::string webp(std::uint32_t components) {
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (std::uint32_t c = 0; c < components; ++c)
        pixels.push_back(static_cast<std::uint8_t>(expected(x, y, c, 255)));
  std::uint8_t* bytes = nullptr;
  const int stride = static_cast<int>(kWidth * components);
  const std::size_t size = components == 4
                               ? WebPEncodeLosslessRGBA(pixels.data(), kWidth, kHeight, stride, &bytes)
                               : WebPEncodeLosslessRGB(pixels.data(), kWidth, kHeight, stride, &bytes);
  std::string file(reinterpret_cast<char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

/// Whether every number is that of expected(), up to `tolerance` of full intensity.
void expect_pixels(const Image& image, std::uint32_t components, std::uint32_t bits, float tolerance) {
  ASSERT_EQ(image.width, kWidth);
  ASSERT_EQ(image.height, kHeight);
  ASSERT_EQ(image.components, components);
  ASSERT_EQ(image.bits, bits);
  const std::uint32_t most = bits == 16 ? 65535 : 255;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (std::uint32_t c = 0; c < components; ++c)
        ASSERT_NEAR(image.value(x, y, c),
                    static_cast<float>(expected(x, y, c, most)) / static_cast<float>(most), tolerance)
            << x << ' ' << y << ' ' << c;
}

TEST(Images, PngOfAllKindsIsExact) {
  for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_GRAY, 8, interlace})), 1, 8, 0);
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_GRAY_ALPHA, 8, interlace})), 2, 8, 0);
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_RGB, 8, interlace})), 3, 8, 0);
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_RGBA, 8, interlace})), 4, 8, 0);
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_GRAY, 16, interlace})), 1, 16, 0);
    expect_pixels(decode_image(png({PNG_COLOR_TYPE_RGBA, 16, interlace})), 4, 16, 0);
  }
  const Image colors = decode_image(png({PNG_COLOR_TYPE_PALETTE, 8}));
  ASSERT_EQ(colors.components, 3u);
  for (std::uint32_t x = 0; x < kWidth; ++x) {
    EXPECT_EQ(colors.value(x, 3, 0), static_cast<float>(expected(x, 3, 0, 255)) / 255.f);
    EXPECT_EQ(colors.value(x, 3, 1), static_cast<float>(255 - expected(x, 3, 0, 255)) / 255.f);
  }
}

TEST(Images, PalettesMayBeTransparent) {
  const Image image = decode_image(png({.color_type = PNG_COLOR_TYPE_PALETTE, .transparent = true}));
  ASSERT_EQ(image.components, 4u);
  for (std::uint32_t x = 0; x < kWidth; ++x) {
    EXPECT_EQ(image.value(x, 3, 0), static_cast<float>(expected(x, 3, 0, 255)) / 255.f);
    EXPECT_EQ(image.value(x, 3, 3), static_cast<float>(255 - expected(x, 3, 0, 255)) / 255.f);
  }
}

TEST(Images, JpegIsThatOfItsEncoder) {
  expect_pixels(decode_image(jpeg(JCS_GRAYSCALE, 1)), 1, 8, 2.f / 255);
  expect_pixels(decode_image(jpeg(JCS_RGB, 3)), 3, 8, 4.f / 255);
  expect_pixels(decode_image(jpeg(JCS_RGB, 3, {.progressive = true})), 3, 8, 4.f / 255);
}

// The encoder marks CMYK as Adobe's: the numbers are what each ink lets through.
TEST(Images, JpegOfFourInksBecomesColors) {
  const Image image = decode_image(jpeg(JCS_CMYK, 4));
  ASSERT_EQ(image.components, 3u);
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (std::uint32_t c = 0; c < 3; ++c)
        ASSERT_NEAR(image.value(x, y, c),
                    static_cast<float>(expected(x, y, c, 255) * expected(x, y, 3, 255)) / (255.f * 255.f),
                    4.f / 255);
}

// Others than Adobe's programs store how much ink there is.
TEST(Images, JpegOfFourInksThatIsNotOfAdobeIsNotInverted) {
  const Image image = decode_image(jpeg(JCS_CMYK, 4, {.adobe = false}));
  ASSERT_EQ(image.components, 3u);
  const auto through = [](std::uint32_t ink) { return 1 - static_cast<float>(ink) / 255; };
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x)
      for (std::uint32_t c = 0; c < 3; ++c)
        ASSERT_NEAR(image.value(x, y, c), through(expected(x, y, c, 255)) * through(expected(x, y, 3, 255)),
                    4.f / 255);
}

TEST(Images, WebpIsExactWithoutLoss) {
  expect_pixels(decode_image(webp(3)), 3, 8, 0);
  const Image image = decode_image(webp(4));
  ASSERT_EQ(image.components, 4u);
  EXPECT_EQ(image.value(5, 6, 3), static_cast<float>(expected(5, 6, 3, 255)) / 255.f);
}

TEST(Images, CutAtEveryLengthIsAnErrorOfOneLine) {
  for (const std::string& file :
       {png({}), jpeg(JCS_RGB, 3), jpeg(JCS_RGB, 3, {.progressive = true}), webp(4)})
    for (std::size_t length = 0; length + 12 < file.size(); length += 1 + length / 64) {
      const std::string message = error_of([&] { (void)decode_image(std::span(file).first(length)); });
      ASSERT_THAT(message, HasSubstr("picture")) << length << " of " << file.size();
      ASSERT_EQ(message.find('\n'), std::string::npos);
    }
}

// Once, only a JPEG without its end was refused: one with the end behind half of its data came out grey.
TEST(Images, AJpegWithoutItsMiddleIsRefused) {
  const std::string file = jpeg(JCS_RGB, 3);
  const std::string cut = file.substr(0, file.size() * 3 / 4) + "\xff\xd9";
  EXPECT_THAT(error_of([&] { (void)decode_image(cut); }), HasSubstr("picture"));
}

TEST(Images, DamagedBytesAreReadOrRefused) {
  std::mt19937 random(7);
  for (const std::string& file : {png({PNG_COLOR_TYPE_RGBA, 16}), jpeg(JCS_RGB, 3), webp(3)})
    for (int i = 0; i < 300; ++i) {
      std::string damaged = file;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      try {
        const Image image = decode_image(damaged);
        ASSERT_EQ(image.bytes.size(),
                  std::size_t{image.width} * image.height * image.components * (image.bits / 8));
      } catch (const Error& error) {
        ASSERT_FALSE(std::string(error.what()).empty());
      }
    }
}

/// A PNG whose header declares another size than it has.
std::string png_of_size(std::uint32_t width, std::uint32_t height) {
  std::string file = png({});
  const auto set = [&](std::size_t at, std::uint32_t value) {
    std::string bytes;
    put(bytes, value, std::endian::big);
    file.replace(at, 4, bytes);
  };
  set(16, width);
  set(20, height);
  std::string checked = file.substr(12, 17), crc;
  put(crc, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(checked.data()), 17)),
      std::endian::big);
  return file.replace(29, 4, crc);
}

/// The same of a JPEG, whose frame header is a marker, its length, the bits, then height and width.
std::string jpeg_of_size(std::uint16_t width, std::uint16_t height) {
  std::string file = jpeg(JCS_RGB, 3), size;
  put(size, height, std::endian::big);
  put(size, width, std::endian::big);
  return file.replace(file.find("\xff\xc0") + 5, 4, size);
}

/// The same of a lossless WebP: after "VP8L", the size of the chunk and a signature, 14 bits of width - 1 and
/// 14 of height - 1.
std::string webp_of_size(std::uint32_t width, std::uint32_t height) {
  std::string file = webp(4), size;
  put(size, (width - 1) | (height - 1) << 14 | 1u << 28, std::endian::little);
  return file.replace(file.find("VP8L") + 9, 4, size);
}

// Declared in a few bytes: refused before memory is taken.
TEST(Images, TooLargeOnesAreRefused) {
  const auto refusal = [](const std::string& file) { return error_of([&] { (void)decode_image(file); }); };
  EXPECT_EQ(refusal(png_of_size(100'000, 100'000)), "the picture has 100000 × 100000 pixels, more than 2^28");
  EXPECT_EQ(refusal(png_of_size(1, 100'001)), "the picture has 1 × 100001 pixels, more than 100000 a side");
  EXPECT_EQ(refusal(jpeg_of_size(65'000, 65'000)), "the picture has 65000 × 65000 pixels, more than 2^28");
  // WebP permits 2^14 pixels a side at most; the data are missing.
  EXPECT_THAT(refusal(webp_of_size(16'384, 16'384)), StartsWith("the WebP picture cannot be read"));
}

TEST(Images, ThoseWithoutPixelsAreRefused) {
  for (const std::string& file :
       {png_of_size(0, 5), png_of_size(5, 0), jpeg_of_size(0, 5), jpeg_of_size(5, 0)})
    EXPECT_THAT(error_of([&] { (void)decode_image(file); }), HasSubstr("picture"));
}

TEST(Images, OfOtherFormatsAreRefusedByName) {
  EXPECT_EQ(error_of([] { (void)decode_image(std::string("GIF89a and more")); }),
            "the picture is not PNG, JPEG or WebP");
  const auto file = write_file("a.png", "not a picture");
  EXPECT_EQ(error_of([&] { (void)read_image(file); }),
            file.string() + ": the picture is not PNG, JPEG or WebP");
}

}  // namespace
}  // namespace sdm::test
