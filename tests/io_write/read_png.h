// Reads the pixels of PNG files.
#pragma once

#include "io/image/pictures/color_scale.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sdm::test {

using io::Rgb;

struct Pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgb> colors;
  [[nodiscard]] Rgb at(std::size_t x, std::size_t y) const { return colors[y * width + x]; }
};

inline Pixels read_png(const std::filesystem::path& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << image.message;
  image.format = PNG_FORMAT_RGB;
  Pixels pixels{image.width, image.height, std::vector<Rgb>(std::size_t{image.width} * image.height)};
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.colors.data(), 0, nullptr)) << image.message;
  return pixels;
}

}  // namespace sdm::test
