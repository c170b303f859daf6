// Baked textures against the look of O2 itself.
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "support/error_of.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/srgb.h"

namespace sdm::test {
namespace {

using Color = std::array<double, 3>;

/// A picture of 8 bits; `value` from 0 to 1, at the middles of pixels, in units of the picture.
Image picture_of(std::uint32_t width, std::uint32_t height, std::uint32_t components,
                 const std::function<double(double x, double y, std::uint32_t k)>& value) {
  Image image{.width = width, .height = height, .components = components, .bits = 8, .bytes = {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (std::uint32_t k = 0; k < components; ++k)
        image.bytes.push_back(
            static_cast<std::uint8_t>(std::lround(255 * value((x + 0.5) / width, (y + 0.5) / height, k))));
  return image;
}

double smooth(double x, double y, std::uint32_t k) {
  return 0.5 + 0.2 * std::sin(6.283185307179586 * (x + 0.3 * k)) +
         0.2 * std::cos(6.283185307179586 * (y + x + 0.17 * k));
}

std::int64_t wrapped_by(std::int64_t i, std::int64_t n, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp<std::int64_t>(i, 0, n - 1);
  const std::int64_t period = wrap == TextureWrap::mirror ? 2 * n : n, rest = (i % period + period) % period;
  return rest < n ? rest : period - 1 - rest;
}

/// Bilinear in linear light, at texture coordinates.
Color sampled(const Image& image, const TextureUse& use, const Vec2& uv) {
  const auto& p = use.place;
  const double x = (p[0][0] * uv[0] + p[0][1] * uv[1] + p[0][2]) * image.width - 0.5,
               y = (1 - p[1][0] * uv[0] - p[1][1] * uv[1] - p[1][2]) * image.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  Color color{};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double weight = (j == 0 ? 1 - (x - left) : x - left) * (i == 0 ? 1 - (y - top) : y - top);
      const auto column = wrapped_by(static_cast<std::int64_t>(left) + j, image.width, use.wrap[0]),
                 row = wrapped_by(static_cast<std::int64_t>(top) + i, image.height, use.wrap[1]);
      for (std::uint32_t k = 0; k < 3; ++k)
        color[k] += weight * linear_of(image.value(static_cast<std::uint32_t>(column),
                                                   static_cast<std::uint32_t>(row), k));
    }
  return color;
}

Vec2 uv_of(const Mesh& mesh, const SurfacePoint& point) {
  const auto& uvs = mesh.corner_uvs[point.face];
  const Vec3& w = point.barycentric;
  return w[0] * uvs[0] + w[1] * uvs[1] + w[2] * uvs[2];
}

struct Baking : ::testing::Test {
  Surface surface{height_field(6), {.resolution = 64}};
  Mesh high = height_field(64);
  std::vector<Material> materials{Material{}};
  std::vector<std::uint32_t> face_materials;
  std::vector<Image> pictures;
  std::vector<MeshAttribute> attributes;
  double max_distance = std::numeric_limits<double>::infinity();

  [[nodiscard]] MeshLook look() const { return {materials, face_materials, pictures, attributes}; }
  void SetUp() override { face_materials.assign(high.triangles.size(), 0); }

  [[nodiscard]] std::vector<BakedChannel> baked(const std::vector<BakeChannel>& channels,
                                                bool fill = true) const {
    const Sites sites(high);
    const DistanceMap map = compute_map(surface, sites, {.max_distance = max_distance});
    return bake(surface, sites, matches_of(surface, sites, map), look(), channels, {.fill = fill});
  }
  [[nodiscard]] BakedChannel baked(BakeChannel channel, bool fill = true) const {
    return baked(std::vector{channel}, fill).front();
  }
  /// Of the mean of the closest points on O2 of 64 points of each texel, at most a level of 8 bits. Points of
  /// texels at a border lie beside O1.
  void expect_close_to_points(const BakedChannel& result) const {
    const Sites sites(high);
    const Image image = to_image(result);
    const auto owners = surface.texel_faces();
    std::size_t compared = 0;
    for (const std::uint32_t texel : test::owned_texels(surface)) {
      if (std::ranges::any_of(std::array{texel - 1, texel + 1, texel - 64, texel + 64},
                              [&](std::uint32_t i) { return i >= owners.size() || owners[i] == kNone; }))
        continue;
      ++compared;
      std::vector<Vec3> points;
      for (int i = 0; i < 64; ++i)
        points.push_back(surface.to_surface(
            owners[texel], {texel % 64 + (i % 8 + 0.5) / 8, texel / 64 + (i / 8 + 0.5) / 8}));  // NOLINT
      Color mean{};
      for (const ClosestPoint& closest : closest_points(sites, points)) {
        const SurfacePoint on = point_on_face(sites, closest.type, closest.site, closest.point);
        const TextureUse& use = materials[0].base_color_texture;
        const Color color = sampled(pictures[use.texture], use, uv_of(high, on));
        for (int k = 0; k < 3; ++k) mean[k] += color[k] / 64;
      }
      for (std::uint32_t k = 0; k < 3; ++k)
        ASSERT_NEAR(image.bytes[3 * std::size_t{texel} + k], std::round(255 * srgb_of(mean[k])), 1)
            << texel << ' ' << k;
    }
    EXPECT_GT(compared, surface.owned_texels() * 3 / 4);
  }
};

TEST_F(Baking, SmoothTexturesAreWithinALevelOf64PointsATexel) {
  materials[0].base_color_texture = {
      .texture = 0, .place = {{{0.8, -0.3, 0.2}, {0.4, 0.6, -0.1}}}, .wrap = {TextureWrap::repeat, {}}};
  for (const auto& [width, height] : {std::array{37u, 64u}, {128u, 128u}, {257u, 1031u}}) {
    pictures = {picture_of(width, height, 3, smooth)};
    expect_close_to_points(baked(BakeChannel::base_color));
  }
}

TEST_F(Baking, PicturesRepeatMirrorAndClamp) {
  pictures = {picture_of(64, 64, 3, [](double x, double y, std::uint32_t k) {
    return 0.5 + 0.3 * std::cos(3.141592653589793 * x) + 0.1 * k * y;
  })};
  for (const TextureWrap wrap : {TextureWrap::mirror, TextureWrap::clamp}) {
    materials[0].base_color_texture = {
        .texture = 0, .place = {{{3, 0, -1}, {0, 1, 0}}}, .wrap = {wrap, TextureWrap::clamp}};
    expect_close_to_points(baked(BakeChannel::base_color));
  }
}

// Every texel covers hundreds of pixels of noise: what is not averaged is far from the mean.
TEST_F(Baking, NoiseBecomesItsMeanInLinearLight) {
  pictures = {picture_of(1021, 1024, 3, [](double x, double y, std::uint32_t) {
    const auto i = static_cast<std::uint32_t>(x * 1021), j = static_cast<std::uint32_t>(y * 1024);
    return ((i * 2654435761u) ^ (j * 40503u) ^ ((i * j) << 7)) >> 13 & 1u;
  })};
  materials[0].base_color_texture = {.texture = 0};
  double mean = 0, most = 0;
  for (const std::uint8_t byte : pictures[0].bytes) mean += byte / 255.0;
  mean /= static_cast<double>(pictures[0].bytes.size());
  const BakedChannel result = baked(BakeChannel::base_color);
  double sum = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const double value = result.values[3 * std::size_t{texel}];
    sum += value;
    most = std::max(most, std::abs(value - mean));
  }
  EXPECT_NEAR(sum / static_cast<double>(surface.owned_texels()), mean, 0.005);
  EXPECT_LT(most, 0.25);
}

TEST_F(Baking, FactorsTexturesAndVertexColorsMultiply) {
  pictures = {picture_of(4, 4, 4, [](double, double, std::uint32_t k) { return 0.2 * k + 0.2; })};
  auto rows = std::make_shared<std::vector<Triangle>>(high.triangles);
  attributes = {{.name = "color", .components = 3, .values = {}, .rows = rows}};
  for (std::size_t v = 0; v < high.positions.size(); ++v)
    for (const float x : {0.5f, 0.25f, 1.f}) attributes[0].values.push_back(x);
  Material& m = materials[0];
  m.base_color = {0.5f, 1, 0.75f, 0.5f};
  m.metallic = 0.5f;
  m.roughness = 0.25f;
  m.occlusion_strength = 0.5f;
  m.emissive = {1, 0.5f, 0.25f};
  m.alpha_mode = AlphaMode::blend;
  for (TextureUse Material::*use : {&Material::base_color_texture, &Material::metallic_roughness_texture,
                                    &Material::occlusion_texture, &Material::emissive_texture})
    m.*use = {.texture = 0};
  const auto results = baked({kBakeChannels, kBakeChannels + 4});  // NOLINT
  const std::vector<std::vector<double>> expected{
      {0.25 * linear_of(0.2), 0.25 * linear_of(0.4), 0.75 * linear_of(0.6), 0.4},
      {0.25 * 0.4, 0.5 * 0.6},
      {1 + 0.5 * (0.2 - 1)},
      {linear_of(0.2), 0.5 * linear_of(0.4), 0.25 * linear_of(0.6)}};
  ASSERT_EQ(results.size(), expected.size());
  for (std::size_t c = 0; c < results.size(); ++c) {
    ASSERT_EQ(results[c].channel, kBakeChannels[c]);
    ASSERT_EQ(results[c].components, expected[c].size());
    for (std::size_t i = 0; i < results[c].values.size(); ++i)  // all texels are filled
      ASSERT_NEAR(results[c].values[i], expected[c][i % expected[c].size()], 1e-5) << c << ' ' << i;
  }
  EXPECT_EQ(to_image(results[1]).components, 3u);
  EXPECT_EQ(to_image(results[1]).bytes[1], std::lround(255 * 0.1));
  EXPECT_EQ(to_image(results[2]).components, 1u);
}

TEST_F(Baking, EveryFaceHasItsMaterial) {
  materials.resize(2);
  materials[0].base_color = {1, 0, 0, 1};
  materials[1].base_color = {0, 1, 0, 1};
  for (std::size_t f = 0; f < face_materials.size(); ++f)
    face_materials[f] = f < face_materials.size() / 2 ? 0 : f + 1 < face_materials.size() ? 1 : kNone;
  EXPECT_EQ(varying_channels(high, look()), std::vector{BakeChannel::base_color});
  const Sites sites(high);
  const TexelMatches matches = matches_of(surface, sites, compute_map(surface, sites));
  const BakedChannel result = baked(BakeChannel::base_color);
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const std::uint32_t material = face_materials[matches.face[texel]];
    ASSERT_EQ(result.values[3 * std::size_t{texel}], material == 1 ? 0 : 1);
    ASSERT_EQ(result.values[3 * std::size_t{texel} + 2], material == kNone ? 1 : 0);
  }
}

TEST_F(Baking, WithoutAMatchTexelsHaveNoValueUnlessTheyAreFilled) {
  for (Vec3& p : high.positions) p[2] += 0.2 * p[0];
  max_distance = 0.1;
  materials[0].base_color = {0.5f, 0.5f, 0.5f, 1};
  const Sites sites(high);
  const TexelMatches matches =
      matches_of(surface, sites, compute_map(surface, sites, {.max_distance = max_distance}));
  const BakedChannel open = baked(BakeChannel::base_color, false), filled = baked(BakeChannel::base_color);
  std::size_t matched = 0, too_far = 0;
  for (std::size_t i = 0; i < matches.kind.size(); ++i) {
    matched += matches.kind[i] == MatchKind::closest;
    too_far += matches.kind[i] == MatchKind::too_far;
    ASSERT_EQ(matches.kind[i] == MatchKind::none, surface.map_faces()[i] == kNone);
    ASSERT_EQ(std::isnan(open.values[3 * i]), matches.kind[i] != MatchKind::closest);
    ASSERT_NEAR(filled.values[3 * i], 0.5, 1e-6);
  }
  EXPECT_GT(matched, 100u);
  EXPECT_GT(too_far, 100u);
}

TEST_F(Baking, ChannelsThatAreTheSameEverywhereAreFactors) {
  EXPECT_TRUE(varying_channels(high, look()).empty());
  EXPECT_EQ(common_material({}).metallic, 0);
  Material& m = materials[0];
  m.name = "steel";
  m.metallic = 1;
  m.roughness = 0.5f;
  m.alpha_mode = AlphaMode::mask;
  m.emissive_texture = {.texture = 0};
  pictures.emplace_back();  // one that could not be had
  EXPECT_TRUE(varying_channels(high, look()).empty());
  EXPECT_EQ(common_material(look()).roughness, 0.5f);
  EXPECT_EQ(common_material(look()).alpha_mode, AlphaMode::mask);
  EXPECT_EQ(common_material(look()).emissive_texture.texture, kNone);
  pictures[0] = picture_of(2, 2, 1, smooth);
  EXPECT_EQ(varying_channels(high, look()), std::vector{BakeChannel::emissive});
  materials.emplace_back().name = "of no face";
  EXPECT_EQ(varying_channels(high, look()), std::vector{BakeChannel::emissive});
}

TEST_F(Baking, ATextureWithoutCoordinatesLeavesTheFactor) {
  high.corner_uvs.clear();
  pictures = {picture_of(2, 2, 3, smooth)};
  materials[0].base_color = {0.25f, 0.5f, 1, 1};
  for (const std::uint32_t uv_set : {0u, 1u}) {
    materials[0].base_color_texture = {.texture = 0, .uv_set = uv_set};
    const BakedChannel result = baked(BakeChannel::base_color);
    EXPECT_EQ(result.values[0], 0.25f);
    EXPECT_EQ(result.values[2], 1.f);
  }
}

// Files have any numbers: what is no place in a picture has no texture, and what covers all of it its mean.
TEST_F(Baking, ExtremeTextureCoordinatesAreHarmless) {
  pictures = {picture_of(5, 3, 3, smooth)};
  Material& m = materials[0];
  m.base_color = {0.25f, 0.5f, 1, 1};
  const double huge = std::numeric_limits<double>::max();
  for (const double scale : {1e30, huge, std::numeric_limits<double>::quiet_NaN()}) {
    m.base_color_texture = {.texture = 0, .place = {{{scale, scale, 0}, {0, 1, 0}}}};
    EXPECT_EQ(baked(BakeChannel::base_color).values[0], 0.25f);
  }
  m.base_color_texture.place = {{{1e9, 0, 0}, {0, 1e9, 0}}};
  for (const float value : baked(BakeChannel::base_color).values)
    ASSERT_TRUE(value > 0 && value < 1) << value;
}

TEST_F(Baking, FurtherTextureCoordinatesAreThoseOfTheAttribute) {
  pictures = {picture_of(64, 64, 3, smooth)};
  materials[0].base_color_texture = {.texture = 0};
  const BakedChannel first = baked(BakeChannel::base_color);
  auto rows = std::make_shared<std::vector<Triangle>>();
  attributes = {{.name = "uv1", .components = 2, .values = {}, .rows = rows}};
  for (const auto& uvs : high.corner_uvs) {
    const auto row = static_cast<std::uint32_t>(attributes[0].values.size() / 2);
    rows->push_back({row, row + 1, row + 2});
    for (const Vec2& uv : uvs)
      for (const double x : uv) attributes[0].values.push_back(static_cast<float>(x));
  }
  high.corner_uvs.clear();
  materials[0].base_color_texture.uv_set = 1;
  const BakedChannel second = baked(BakeChannel::base_color);
  for (std::size_t i = 0; i < first.values.size(); ++i) ASSERT_NEAR(first.values[i], second.values[i], 1e-5);
  // The first ones are, too, where only some faces have them: the others have the factor.
  attributes[0].name = "uv0";
  materials[0].base_color_texture.uv_set = 0;
  EXPECT_EQ(baked(BakeChannel::base_color).values, second.values);
  (*rows)[0].fill(kNone);
  EXPECT_NE(baked(BakeChannel::base_color).values, second.values);
}

TEST_F(Baking, WhatDoesNotFitIsRefused) {
  const Sites sites(high);
  TexelMatches matches = matches_of(surface, sites, compute_map(surface, sites));
  const auto error = [&] {
    return error_of([&] { return bake(surface, sites, matches, look(), kBakeChannels); });
  };
  EXPECT_EQ(error(), "");
  face_materials.pop_back();
  EXPECT_EQ(error(), "a mesh of 8192 faces needs as many numbers of materials, not 8191");
  face_materials.push_back(7);
  EXPECT_EQ(error(), "a face refers to material 7 of 1");
  face_materials.back() = 0;
  materials[0].occlusion_texture.texture = 3;
  EXPECT_EQ(error(), "a material refers to picture 3 of 0");
  materials[0] = {};
  pictures = {picture_of(4, 4, 3, smooth)};
  pictures[0].bytes.pop_back();
  EXPECT_EQ(error(), "the bytes of a picture are not those of its pixels");
  pictures.clear();
  attributes = {{.name = "color",
                 .components = 3,
                 .values = std::vector<float>(6),
                 .rows = std::make_shared<std::vector<Triangle>>(high.triangles.size(), Triangle{0, 1, 2})}};
  EXPECT_EQ(error(), "the attribute `color` belongs to another mesh");
  attributes.clear();
  matches.face[surface.sample_texels()[0]] = 8192;
  EXPECT_EQ(error(), "the matches name a face that the other mesh does not have");
  matches.face.pop_back();
  EXPECT_EQ(error(), "the matches belong to another surface: their number of texels differs");
}

TEST(BakedImages, HaveTheNearestOf256Colors) {
  BakedChannel all{BakeChannel::emissive, 256, 3, {}};
  for (int i = 0; i < 256; ++i)
    for (const double off : {-0.49, 0.0, 0.49})
      all.values.push_back(static_cast<float>(linear_of(std::max(0.0, (i + off) / 255))));
  const Image image = to_image(all);
  ASSERT_EQ(image.bytes.size(), 768u);
  for (std::size_t i = 0; i < 768; ++i) ASSERT_EQ(image.bytes[i], i / 3) << i;
  all.values.assign(768, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(to_image(all).bytes, std::vector<std::uint8_t>(768));
  all.values.assign(768, 7);
  EXPECT_EQ(to_image(all).bytes, std::vector<std::uint8_t>(768, 255));
}

// Regression: the number after the last one was read.
TEST(BakedImages, OfRoughnessAndMetallicNeedTwoNumbers) {
  EXPECT_THROW((void)to_image({BakeChannel::metallic_roughness, 2, 1, {0.25f, 0.5f, 0.75f, 1}}), Error);
  EXPECT_EQ(to_image({BakeChannel::metallic_roughness, 1, 2, {0, 1}}).bytes,
            (std::vector<std::uint8_t>{255, 0, 255}));
}

}  // namespace
}  // namespace sdm::test
