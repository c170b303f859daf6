// The distance as a plain texture.
#include <gtest/gtest.h>
#include <png.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "support/made_up_maps.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

/// The values as they are stored: libpng's simple interface would take them for brightnesses.
std::vector<std::uint16_t> stored_values(const std::filesystem::path& file, std::uint32_t n) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"), std::fclose);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::vector<std::uint16_t> values(std::size_t{n} * n);
  if (setjmp(png_jmpbuf(png)) == 0) {
    png_init_io(png, in.get());
    png_read_info(png, info);
    EXPECT_EQ(png_get_image_width(png, info), n);
    EXPECT_EQ(png_get_image_height(png, info), n);
    EXPECT_EQ(png_get_bit_depth(png, info), 16);
    EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
    png_set_swap(png);
    for (std::uint32_t y = 0; y < n; ++y)
      png_read_row(png, reinterpret_cast<png_bytep>(&values[std::size_t{y} * n]), nullptr);
  } else {
    ADD_FAILURE() << "libpng cannot read the texture";
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return values;
}

TEST(Texture, HasTheDistancesInItsRange) {
  for (const std::uint32_t gutter : {0u, 1u, 9u}) {
    const Surface surface(ring(6), {.resolution = 256, .gutter = gutter});
    const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[2] < 0.2 ? p[0] : std::nan(""); });
    const TemporaryFolder folder;
    const TextureRange range = write_distance_texture(folder / "t.png", surface, map);
    EXPECT_EQ(range.lower, -range.upper) << "of both signs";
    const std::vector<std::uint16_t> values = stored_values(folder / "t.png", 256);
    const int reach = static_cast<int>(std::max(4u, gutter));
    const auto owners = surface.texel_faces();
    std::size_t filled = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const std::size_t texel = static_cast<std::size_t>(256 * y + x);
        if (owners[texel] != kNone) {
          if (std::isnan(map.distance[texel])) {
            ASSERT_EQ(values[texel], 0);
          } else {
            ASSERT_NEAR(range.lower + values[texel] / 65535.0 * (range.upper - range.lower),
                        map.distance[texel], (range.upper - range.lower) / 131000);
          }
          continue;
        }
        // Of one of the nearest owned texels, or nothing beyond the gutter.
        constexpr int kRing = 1000;
        const int beyond = (reach + 1) * kRing;
        int nearest = beyond;
        bool matches = false;
        for (int j = std::max(0, y - reach); j <= std::min(255, y + reach); ++j)
          for (int i = std::max(0, x - reach); i <= std::min(255, x + reach); ++i) {
            const std::size_t other = static_cast<std::size_t>(256 * j + i);
            const int distance =
                kRing * std::max(std::abs(i - x), std::abs(j - y)) + (i - x) * (i - x) + (j - y) * (j - y);
            if (owners[other] == kNone || distance > nearest) continue;
            if (distance < nearest) matches = false;
            nearest = distance;
            matches = matches || values[other] == values[texel];
          }
        ASSERT_TRUE(nearest == beyond ? values[texel] == 0 : matches) << x << ", " << y;
        filled += nearest < beyond;
      }
    EXPECT_GT(filled, 500u);
  }
}

TEST(Texture, ClampsToAGivenRange) {
  const Surface surface(ring(6), {.resolution = 64});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[0]; });
  const TemporaryFolder folder;
  const TextureRange range =
      write_distance_texture(folder / "t.png", surface, map, {.range = {{-0.25, 0.5}}, .tolerance = 0.1});
  EXPECT_EQ(range.lower, -0.25);
  EXPECT_EQ(range.upper, 0.5);
  const std::vector<std::uint16_t> values = stored_values(folder / "t.png", 64);
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    if (map.distance[texel] <= -0.25f) {
      ASSERT_EQ(values[texel], 0);
    } else if (map.distance[texel] >= 0.5f) {
      ASSERT_EQ(values[texel], 65535);
    }
  }
  write_texture_range(folder / "t.json", "t.png", range, "mm");
  std::ifstream in(folder / "t.json");
  const auto json = nlohmann::json::parse(in);
  EXPECT_EQ(json["texture"], "t.png");
  EXPECT_EQ(json["lower"], -0.25);
  EXPECT_EQ(json["upper"], 0.5);
  EXPECT_EQ(json["units"], "mm");
}

}  // namespace
}  // namespace sdm::test
