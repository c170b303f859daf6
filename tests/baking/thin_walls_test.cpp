// Baking from plates that are thinner than a coarse copy of them is exact.
#include <gtest/gtest.h>
#include <sdm/bake.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "support/owned_texels.h"

namespace sdm::test {
namespace {

/// A quarter of a tube of radius 1 and length 1, cut into n strips: its outer skin, and its inner skin at a
/// distance, facing inwards. The first half of the faces is outside.
Mesh bent_plate(int n, double thickness) {
  Mesh mesh;
  for (const double radius : {1.0, 1 - thickness})
    for (int i = 0; i <= n; ++i)
      for (const double z : {0.0, 1.0}) {
        const double angle = 1.5707963267948966 * i / n;
        mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
  for (std::uint32_t skin = 0; skin < 2; ++skin)
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
      const std::uint32_t a = 2 * (skin * static_cast<std::uint32_t>(n + 1) + i), b = a + 1, c = a + 2,
                          d = a + 3;
      mesh.triangles.push_back(skin == 0 ? Triangle{a, c, b} : Triangle{a, b, c});
      mesh.triangles.push_back(skin == 0 ? Triangle{c, d, b} : Triangle{c, b, d});
    }
  return mesh;
}

/// The share of the texels of each skin that have a colour of the other one.
double wrong_share(double thickness, std::optional<double> facing) {
  const Mesh high = bent_plate(200, thickness);
  const Surface low(bent_plate(4, thickness), {.resolution = 128});
  const Sites sites(high);
  std::vector<Material> materials(2);
  materials[0].base_color = {1, 0, 0, 1};
  materials[1].base_color = {0, 0, 1, 1};
  std::vector<std::uint32_t> of_faces(high.triangles.size(), 1);
  std::fill_n(of_faces.begin(), of_faces.size() / 2, 0);
  const TexelMatches matches =
      matches_of(low, sites, compute_map(low, sites, {.sign = SignMethod::none, .facing = facing}));
  const BakedChannel baked = bake(low, sites, matches, {.materials = materials, .face_materials = of_faces},
                                  std::vector{BakeChannel::base_color})
                                 .front();
  const auto owners = low.texel_faces();
  std::size_t wrong = 0;
  for (const std::uint32_t texel : test::owned_texels(low)) {
    const bool outside = owners[texel] < low.mesh().triangles.size() / 2;
    wrong += baked.values[3 * std::size_t{texel} + (outside ? 0 : 2)] != 1;
  }
  return static_cast<double>(wrong) / static_cast<double>(low.owned_texels());
}

// The chords of the coarse plate are 0.019 deep.
TEST(ThinWalls, HaveTheColorOfTheirOwnSideIfFacesMustFace) {
  for (const double thickness : {0.001, 0.004, 0.02, 0.1}) {
    EXPECT_EQ(wrong_share(thickness, 90), 0) << thickness;
    const double by_distance = wrong_share(thickness, std::nullopt);
    EXPECT_EQ(by_distance > 0.2, thickness < 0.05) << by_distance;
  }
}

}  // namespace
}  // namespace sdm::test
