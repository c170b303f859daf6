// Filled textures, and the smaller ones that renderers make of them.
#include <gtest/gtest.h>
#include <sdm/bake.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// Every chart has a material of its own.
struct Charts {
  Surface surface;
  std::vector<Material> materials;
  std::vector<std::uint32_t> of_faces;

  Charts(const Mesh& mesh, std::uint32_t gutter)
      : surface(mesh, {.kind = AtlasKind::charts, .resolution = 256, .gutter = gutter}) {
    materials.resize(surface.chart_count());
    for (std::size_t m = 0; m < materials.size(); ++m)
      for (std::size_t k = 0; k < 3; ++k)
        materials[m].base_color[k] = static_cast<float>((m * (3 + 5 * k) + k) % 17) / 16;
    of_faces.assign(surface.face_charts().begin(), surface.face_charts().end());
  }
  [[nodiscard]] std::uint32_t chart_of(std::size_t texel) const {
    const std::uint32_t face = surface.map_faces()[texel];
    return face == kNone ? kNone : surface.face_charts()[face];
  }
};

// O2 is O1, so that each texel has the material of its own chart, which is all that its gutter may have.
TEST(Bleed, MipmapsOfAChartHaveItsColorsUpToTheGutter) {
  for (const std::uint32_t gutter : {4u, 8u}) {
    const Charts charts(sphere(2), gutter);
    const Surface& surface = charts.surface;
    ASSERT_GT(surface.chart_count(), 4u);
    const Sites sites(surface.mesh());
    const BakedChannel baked =
        bake(surface, sites, match_texels(surface, sites, {.method = MatchMethod::closest}),
             {.materials = charts.materials, .face_materials = charts.of_faces},
             std::array{BakeChannel::base_color})
            .front();
    for (const float value : baked.values) ASSERT_TRUE(std::isfinite(value));
    const std::uint32_t n = surface.resolution();
    // A sample on the border of its chart may belong to the chart beside it: what counts is what it got.
    const auto color_of = [&](std::size_t texel) {
      return std::array{baked.values[3 * texel], baked.values[3 * texel + 1], baked.values[3 * texel + 2]};
    };
    std::map<std::uint32_t, std::set<std::array<float, 3>>> colors;  // of the texels of each chart
    for (const std::uint32_t texel : test::owned_texels(surface))
      colors[charts.chart_of(texel)].insert(color_of(texel));
    std::size_t checked = 0;
    for (std::uint32_t side = 2; side <= gutter; side *= 2)
      for (std::uint32_t y = 0; y < n; y += side)
        for (std::uint32_t x = 0; x < n; x += side) {
          std::set<std::uint32_t> owners;
          std::set<std::array<float, 3>> all;
          for (std::uint32_t i = y; i < y + side; ++i)
            for (std::uint32_t j = x; j < x + side; ++j) {
              const std::size_t texel = std::size_t{i} * n + j;
              all.insert(color_of(texel));
              if (charts.chart_of(texel) != kNone) owners.insert(charts.chart_of(texel));
            }
          if (owners.empty()) continue;
          ++checked;
          ASSERT_EQ(owners.size(), 1u) << "charts share a texel of level " << side;
          // Free texels of the square repeat those of the chart around it, nothing else.
          const auto& own = colors.at(*owners.begin());
          for (const auto& color : all)
            ASSERT_TRUE(own.count(color) > 0)
                << "another colour at " << x << ", " << y << " of squares of " << side;
        }
    EXPECT_GT(checked, 200u);
  }
}

TEST(Bleed, ValuesOfAllTexelsAreFilledSmoothly) {
  std::vector<float> values(64 * 64, std::numeric_limits<float>::quiet_NaN());
  values[64 * 10 + 10] = 1;
  values[64 * 50 + 50] = 3;
  fill_texels(64, 1, values, 4);
  EXPECT_EQ(values[64 * 12 + 12], 1);
  EXPECT_EQ(values[64 * 50 + 47], 3);
  for (const float value : values) {
    ASSERT_GE(value, 1);
    ASSERT_LE(value, 3);
  }
  std::vector<float> none(64, std::numeric_limits<float>::quiet_NaN());
  fill_texels(8, 1, none, 4);
  EXPECT_TRUE(std::ranges::all_of(none, [](float x) { return std::isnan(x); }));
}

}  // namespace
}  // namespace sdm::test
