#include <sdm/map_files.h>

#include <array>
#include <cmath>
#include <set>

#include "io_write/read_png.h"
#include "support/made_up_maps.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using namespace io;

struct Pictures : ::testing::Test {
  const Surface surface{ring(6), {.kind = AtlasKind::charts, .resolution = 256}};
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[2] < 0.2 ? p[0] : std::nan(""); });
  const std::size_t n = surface.resolution();
  TemporaryFolder folder;

  /// Calls check(texel, colour) for every owned texel, and expects the background everywhere else.
  void for_each_texel(const Pixels& pixels, const std::function<void(std::size_t, Rgb)>& check) {
    for (std::size_t y = 0; y < n; ++y)
      for (std::size_t x = 0; x < n; ++x) {
        const std::size_t texel = y * n + x;
        if (surface.map_faces()[texel] == kNone)
          ASSERT_EQ(pixels.at(x, y), kBackground);
        else
          check(texel, pixels.at(x, y));
      }
  }
};

TEST_F(Pictures, DistanceHasTheColoursOfTheScaleAndALegend) {
  for (const PictureOptions& options : {PictureOptions{}, PictureOptions{.units = "mm"},
                                        PictureOptions{.colormap = Colormap::viridis, .range = {{-1, 0.5}}},
                                        PictureOptions{.tolerance = 0.3}}) {
    write_distance_png(folder / "distance.png", surface, map, options);
    const Pixels pixels = read_png(folder / "distance.png");
    const ColorScale scale = color_scale(surface, map, options);
    for_each_texel(pixels,
                   [&](std::size_t texel, Rgb color) { ASSERT_EQ(color, scale(map.distance[texel])); });

    ASSERT_GT(pixels.width, n + 100);
    ASSERT_GE(pixels.height, n);
    std::size_t dark = 0, colored = 0;
    for (std::size_t y = 0; y < pixels.height; ++y)
      for (std::size_t x = n; x < pixels.width; ++x) {
        const Rgb c = pixels.at(x, y);
        dark += c.r < 80 && c.g < 80 && c.b < 80;
        colored += std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}) > 40;
      }
    EXPECT_GT(dark, 200u) << "no text";
    EXPECT_GT(colored, 1000u) << "no colour bar";
  }
}

TEST_F(Pictures, LegendNamesTheUnits) {
  write_distance_png(folder / "a.png", surface, map, {.units = "mm"});
  write_distance_png(folder / "b.png", surface, map, {.units = "inches of the old kind"});
  const Pixels a = read_png(folder / "a.png"), b = read_png(folder / "b.png");
  ASSERT_EQ(a.width, b.width);
  EXPECT_NE(a.colors, b.colors);
}

TEST_F(Pictures, VoronoiHasOneColourPerSite) {
  write_voronoi_png(folder / "voronoi.png", surface, map);
  const Pixels pixels = read_png(folder / "voronoi.png");
  ASSERT_GT(pixels.width, n + 100);
  ASSERT_GE(pixels.height, n);
  // The legend shows faces, edges and vertices, and texels without a value.
  std::set<std::array<std::uint8_t, 3>> swatches;
  for (std::size_t y = 0; y < pixels.height; ++y)
    for (std::size_t x = n; x < pixels.width; ++x) {
      const Rgb c = pixels.at(x, y);
      swatches.insert({c.r, c.g, c.b});
    }
  for (const SiteType type : {SiteType::face, SiteType::edge, SiteType::vertex, SiteType::none}) {
    const Rgb c = site_color(type, 0);
    EXPECT_TRUE(swatches.contains({c.r, c.g, c.b}));
  }
  for_each_texel(pixels, [&](std::size_t texel, Rgb color) {
    const bool missing = map.site_type[texel] == SiteType::none;
    ASSERT_EQ(color, missing ? kNoValue : site_color(map.site_type[texel], map.site[texel]));
  });
}

TEST_F(Pictures, NothingInRangeHasItsOwnColourOutsideTheScale) {
  const auto field = [](double none) { return [none](const Vec3& p) { return p[2] > 0.2 ? none : p[0]; }; };
  const DistanceMap endless = map_of(surface, field(std::numeric_limits<double>::infinity())),
                    nan = map_of(surface, field(std::nan("")));
  ASSERT_GT(endless.beyond_max_distance, 0u);
  EXPECT_EQ(color_scale(surface, endless, {}).lower, color_scale(surface, nan, {}).lower);
  EXPECT_EQ(color_scale(surface, endless, {}).upper, color_scale(surface, nan, {}).upper);
  write_distance_png(folder / "distance.png", surface, endless);
  write_direction_png(folder / "direction.png", surface, endless);
  write_voronoi_png(folder / "voronoi.png", surface, endless);
  for (const char* name : {"distance.png", "direction.png", "voronoi.png"})
    for_each_texel(read_png(folder / name), [&](std::size_t texel, Rgb color) {
      ASSERT_TRUE(std::isfinite(endless.distance[texel]) || color == kNoValue) << name;
    });
}

TEST_F(Pictures, DirectionDecodesToTheUnitVector) {
  DistanceMap directed = map;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const auto t = static_cast<float>(texel);
    if (!std::isnan(map.distance[texel]))
      directed.vector[texel] = {std::sin(t) * 1e-3f, std::cos(t) * 1e-3f, -2e-3f};
  }
  write_direction_png(folder / "direction.png", surface, directed);
  for_each_texel(read_png(folder / "direction.png"), [&](std::size_t texel, Rgb color) {
    const Vec3f& v = directed.vector[texel];
    if (std::isnan(v[0])) {
      ASSERT_EQ(color, kNoValue);
      return;
    }
    const float length = std::hypot(v[0], v[1], v[2]);
    ASSERT_NEAR(color.r / 127.5 - 1, v[0] / length, 0.005);
    ASSERT_NEAR(color.g / 127.5 - 1, v[1] / length, 0.005);
    ASSERT_NEAR(color.b / 127.5 - 1, v[2] / length, 0.005);
  });
}

TEST(SmallPicture, IsAtLeastAsHighAsItsLegend) {
  const Surface surface(ring(3), {.kind = AtlasKind::charts, .resolution = 64});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[0]; });
  const TemporaryFolder folder;
  write_distance_png(folder / "distance.png", surface, map);
  EXPECT_GT(read_png(folder / "distance.png").height, 200u);
}

}  // namespace
}  // namespace sdm::test
