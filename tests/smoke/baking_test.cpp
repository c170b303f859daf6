// Matches, transfer and baking: one small case for each, where the answer is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_attributes.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/oracle.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/srgb.h"

namespace sdm::test {
namespace {

/// O1 below O2: two squares, of which the upper one is finer, with texture coordinates from 0 to 1.
struct Squares {
  Mesh low = grid_square(1, 0, 2), high = grid_square(1, 0.1, 5);
  Surface surface{low, {.kind = AtlasKind::uv, .resolution = 37}};
  Sites sites{high};
};

Vec3 place_of(const Mesh& mesh, const SurfacePoint& at) {
  Vec3 sum{};
  for (std::size_t k = 0; k < 3; ++k) sum += at.barycentric[k] * mesh.positions[mesh.triangles[at.face][k]];
  return sum;
}

TEST(SmokeMatches, OfParallelSquaresAreStraightAbove) {
  const Squares squares;
  for (const MatchMethod method : {MatchMethod::closest, MatchMethod::facing, MatchMethod::ray}) {
    const TexelMatches matches = match_texels(squares.surface, squares.sites, {.method = method});
    require_matches(squares.surface, squares.sites, matches);
    for (const std::uint32_t t : test::owned_texels(squares.surface)) {
      const Vec3 expected = squares.surface.texel_point(t) + Vec3{0, 0, 0.1};
      EXPECT_LT(norm(place_of(squares.high, matches.point(t)) - expected), 1e-6);
    }
    EXPECT_EQ(matches.count(method == MatchMethod::ray ? MatchKind::ray : MatchKind::closest) +
                  matches.count(MatchKind::facing),
              squares.surface.owned_texels());
  }
  // A cage that ends below O2, a limit that ends below it, and a square that faces the other way.
  const TexelMatches caged =
      match_texels(squares.surface, squares.sites, {.method = MatchMethod::ray, .cage = 0.05});
  EXPECT_EQ(caged.count(MatchKind::ray), 0u);
  EXPECT_EQ(match_texels(squares.surface, squares.sites, {.max_distance = 0.05}).count(MatchKind::too_far),
            squares.surface.owned_texels());
  EXPECT_EQ(match_texels(squares.surface, Sites(flipped(squares.high))).count(MatchKind::facing_away),
            squares.surface.owned_texels());
  const TexelMatches of_map =
      matches_of(squares.surface, squares.sites, compute_map(squares.surface, squares.sites));
  for (const std::uint32_t t : test::owned_texels(squares.surface))
    EXPECT_LT(
        norm(place_of(squares.high, of_map.point(t)) - squares.surface.texel_point(t) - Vec3{0, 0, 0.1}),
        1e-6);
}

// Of balls, the other one's surface is not along a plane: rays are longer than distances.
TEST(SmokeMatches, OfRaysFromABallAreOnTheBallAroundIt) {
  const Mesh low = sphere(1), high = mapped_by(sphere(2), [](const Vec3&p) { return 1.2 * p; });
  const Surface surface(low, {.resolution = 41});
  const Sites sites(high);
  const MeshAttribute normals = smooth_normals(low);
  const TexelMatches matches =
      match_texels(surface, sites, {.method = MatchMethod::ray, .normals = &normals});
  EXPECT_GT(matches.count(MatchKind::ray), 9 * surface.owned_texels() / 10);
  for (const std::uint32_t t : test::owned_texels(surface)) {
    const Vec3 q = place_of(high, matches.point(t)), p = surface.texel_point(t);
    EXPECT_NEAR(oracle::brute_force(high, q), 0, 1e-6);
    if (matches.kind[t] == MatchKind::ray) {
      EXPECT_GT(dot(normalized(q - p), normalized(p)), 0.97);
    }
  }
}

TEST(SmokeTransfer, LinearArraysStayLinear) {
  const Squares squares;
  const DistanceMap map = compute_map(squares.surface, squares.sites);
  std::vector<float> at_vertices, of_faces, at_corners;
  for (const Vec3& p : squares.high.positions)
    at_vertices.insert(at_vertices.end(), {static_cast<float>(p[0]), static_cast<float>(2 * p[1] - p[0])});
  for (const Triangle& t : squares.high.triangles) {
    of_faces.push_back(static_cast<float>(of_faces.size()));
    for (const std::uint32_t v : t) at_corners.push_back(static_cast<float>(squares.high.positions[v][0]));
  }
  const std::vector<float> vertices = transfer(squares.surface, squares.sites, map, {at_vertices, 2},
                                               {.fill = false}),
                           faces = transfer(squares.surface, squares.sites, map,
                                            {of_faces, 1, AttributeDomain::face}),
                           corners = transfer(squares.surface, squares.sites,
                                              match_texels(squares.surface, squares.sites),
                                              {at_corners, 1, AttributeDomain::corner});
  const std::vector<float> shared = transfer(
      squares.surface, squares.sites, map, {at_vertices, 2, AttributeDomain::corner, squares.high.triangles});
  for (const std::uint32_t t : test::owned_texels(squares.surface)) {
    const Vec3 p = squares.surface.texel_point(t);
    EXPECT_NEAR(vertices[2 * t], p[0], 1e-6);
    EXPECT_NEAR(vertices[2 * t + 1], 2 * p[1] - p[0], 1e-6);
    EXPECT_NEAR(shared[2 * t + 1], 2 * p[1] - p[0], 1e-6);
    EXPECT_NEAR(corners[t], p[0], 1e-6);
    EXPECT_EQ(faces[t], std::floor(faces[t]));
    EXPECT_NEAR(oracle::distance(
                    p + Vec3{0, 0, 0.1},
                    squares.high.positions[squares.high.triangles[static_cast<std::size_t>(faces[t])][0]],
                    squares.high.positions[squares.high.triangles[static_cast<std::size_t>(faces[t])][1]],
                    squares.high.positions[squares.high.triangles[static_cast<std::size_t>(faces[t])][2]]),
                0, 1e-6);
  }
}

TEST(SmokeTransfer, TexelsOfNoFaceAreFilled) {
  const Surface surface(sphere(0), {.resolution = 53, .gutter = 2});
  const Mesh high = sphere(1);
  const Sites sites(high);
  const std::vector<float> ones(high.positions.size(), 0.75f);
  for (const float value : transfer(surface, sites, compute_map(surface, sites), {ones, 1}))
    EXPECT_NEAR(value, 0.75, 1e-6);
  std::vector<float> values(std::size_t{53} * 53, std::nanf(""));
  for (const std::uint32_t t : test::owned_texels(surface)) values[t] = 2;
  std::vector<float> within = values;
  fill_texels(surface, 1, values);
  EXPECT_THAT(values, ::testing::Each(2.f));
  fill_texels(53, 1, within, 4);
  EXPECT_GT(std::ranges::count(within, 2.f), static_cast<std::ptrdiff_t>(surface.owned_texels()));
}

/// Red grows to the right, green to the top; in sRGB.
Image color_ramp(std::uint32_t width, std::uint32_t height) {
  Image image{.width = width, .height = height, .components = 3, .bits = 8, .bytes = {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * srgb_of((x + 0.5) / width))));
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * srgb_of(1 - (y + 0.5) / height))));
      image.bytes.push_back(128);
    }
  return image;
}

TEST(SmokeBake, TexturesOfAnotherMeshArriveAtTheirPlaces) {
  const Squares squares;
  std::vector<Material> materials(2);
  materials[0].base_color = {1, 0.5f, 1, 1};
  materials[0].base_color_texture.texture = 0;
  materials[1] = materials[0];
  materials[1].roughness = 0.25f;
  materials[1].metallic = 1;
  materials[0].emissive_texture = {.texture = 0, .wrap = {TextureWrap::mirror, TextureWrap::clamp}};
  materials[0].emissive = {1, 1, 1};
  materials[0].occlusion_texture.texture = 1;
  std::vector<std::uint32_t> face_materials(squares.high.triangles.size());
  for (std::size_t f = 0; f < 20; ++f) face_materials[f] = 1;  // the left two fifths
  std::vector<Image> pictures{color_ramp(61, 47), color_ramp(5, 3)};
  std::vector<MeshAttribute> attributes(1);
  attributes[0] = {.name = "color",
                   .components = 3,
                   .values = std::vector<float>(3 * squares.high.positions.size(), 1.f),
                   .rows = std::make_shared<const std::vector<Triangle>>(squares.high.triangles)};
  const MeshLook look{materials, face_materials, pictures, attributes};
  const TexelMatches matches = match_texels(squares.surface, squares.sites);
  EXPECT_EQ(varying_channels(squares.high, look).size(), 4u);
  EXPECT_EQ(default_channels(squares.high, look).front(), BakeChannel::base_color);
  EXPECT_EQ(name_of(BakeChannel::occlusion), "occlusion");
  EXPECT_TRUE(is_color(BakeChannel::emissive));
  EXPECT_EQ(common_material(look).base_color[1], 0.5f);
  const std::vector<BakedChannel> baked = bake(squares.surface, squares.sites, matches, look, kBakeChannels);
  ASSERT_EQ(baked.size(), 4u);
  ASSERT_EQ(baked[0].components, 3u);
  for (const std::uint32_t t : test::owned_texels(squares.surface)) {
    const Vec3 p = squares.surface.texel_point(t);
    const double u = p[0] + 0.5, v = p[1] + 0.5;
    const bool left = u < 0.4;
    if (std::min({u, v, 1 - u, 1 - v}) < 0.05 || std::abs(u - 0.4) < 1e-3) continue;  // the picture repeats
    EXPECT_NEAR(baked[0].values[3 * t], u, 0.01);
    EXPECT_NEAR(baked[0].values[3 * t + 1], 0.5 * v, 0.01);
    EXPECT_NEAR(baked[1].values[2 * t], left ? 0.25 : 1, 1e-6);
    EXPECT_NEAR(baked[1].values[2 * t + 1], left ? 1 : 0, 1e-6);
    EXPECT_NEAR(baked[3].values[3 * t], left ? 0 : u, 0.01);
  }
  const std::vector<SurfacePoint> points{matches.point(squares.surface.sample_texels()[200])};
  const Vec3 at = place_of(squares.high, points[0]);
  const LookValues seen = look_at(squares.high, look, BakeChannel::base_color, points, 0.01);
  EXPECT_NEAR(seen.values[0], at[0] + 0.5, 0.02);
  const Image image = to_image(baked[0]);
  EXPECT_EQ(image.width, 37u);
  EXPECT_EQ(to_image(baked[1]).components, 3u);
  const std::uint32_t middle = 18 * 37 + 18;
  EXPECT_NEAR(image.value(18, 18, 0), srgb_of(baked[0].values[3 * middle]), 1.0 / 255);
  const BakeAtlas atlas = bake_atlas(squares.low, {.resolution = 37});
  EXPECT_EQ(atlas.fault, "");
  EXPECT_EQ(atlas.surface.atlas_kind(), AtlasKind::uv);
  EXPECT_EQ(overlap_of(atlas.surface), 0);
  EXPECT_FALSE(bake_atlas(sphere(0), {.resolution = 37}).fault.empty());
}

TEST(SmokeBake, PicturesThatRepeatAreAveragedOverTexels) {
  Squares squares;
  for (auto& corners : squares.high.corner_uvs)
    for (Vec2& uv : corners) uv = Vec2{40 * uv[0] - 3, 31 * uv[1]};
  Image checks{.width = 2, .height = 2, .components = 4, .bits = 16, .bytes = {}};
  for (const int grey : {0, 255, 255, 0})
    for (int k = 0; k < 4; ++k)
      checks.bytes.insert(checks.bytes.end(), 2, static_cast<std::uint8_t>(k < 3 ? grey : 128));
  std::vector<Material> materials(1);
  materials[0].base_color_texture.texture = 0;
  materials[0].alpha_mode = AlphaMode::blend;
  const std::vector<std::uint32_t> face_materials(squares.high.triangles.size());
  const std::vector<Image> pictures{checks};
  const MeshLook look{materials, face_materials, pictures, {}};
  const Sites sites(squares.high);
  const std::vector<BakeChannel> channels{BakeChannel::base_color};
  const std::vector<BakedChannel> baked =
      bake(squares.surface, sites, match_texels(squares.surface, sites), look, channels, {.fill = false});
  ASSERT_EQ(baked[0].components, 4u);
  for (const std::uint32_t t : test::owned_texels(squares.surface)) {
    EXPECT_NEAR(baked[0].values[4 * t], 0.5, 0.15);
    EXPECT_NEAR(baked[0].values[4 * t + 3], 128.0 / 255, 0.01);
  }
}

TEST(SmokeBake, GeometryOfAnotherMeshIsThatOfItsPoints) {
  const Squares squares;
  const TexelMatches matches = match_texels(squares.surface, squares.sites, {.method = MatchMethod::ray});
  const Mesh box = test::box({-2, -2, -0.4}, {2, 2, 0.1});  // O2 with a thickness, whose top is the square
  const Sites solid(box);
  const TexelMatches of_solid = match_texels(squares.surface, solid);
  const MeshAttribute normals = smooth_normals(squares.high), own = smooth_normals(squares.low);
  const std::vector<std::uint32_t> material_of(squares.high.triangles.size(), 3);
  const std::vector<float> up = matched_normals(squares.surface, squares.sites, matches, normals),
                           places = matched_positions(squares.surface, squares.sites, matches),
                           heights = matched_displacements(squares.surface, squares.sites, matches, own),
                           open = matched_occlusion(squares.surface, squares.sites, matches, {.rays = 9}),
                           thick = matched_thickness(squares.surface, solid, of_solid, ThicknessMethod::ray),
                           ball = matched_thickness(squares.surface, solid, of_solid, ThicknessMethod::ball);
  const std::vector<std::uint32_t> numbers =
      matched_materials(squares.surface, squares.sites, matches, material_of);
  for (const std::uint32_t t : test::owned_texels(squares.surface)) {
    const Vec3 p = squares.surface.texel_point(t);
    EXPECT_NEAR(up[3 * t + 2], 1, 1e-6);
    EXPECT_NEAR(places[3 * t], p[0], 1e-6);
    EXPECT_NEAR(places[3 * t + 2], 0.1, 1e-6);
    EXPECT_NEAR(heights[t], 0.1, 1e-6);
    EXPECT_EQ(open[t], 1);
    EXPECT_NEAR(thick[t], 0.5, 1e-6);
    EXPECT_NEAR(ball[t], 0.5, 1e-6);
    EXPECT_EQ(numbers[t], 3u);
  }
  for (const GeometryChannel channel : kGeometryChannels) {
    if (is_number(channel)) continue;
    if (channel == GeometryChannel::normal || channel == GeometryChannel::thickness) continue;
    EXPECT_EQ(
        bake_geometry(squares.surface, squares.sites, matches, channel, {.occlusion = {.rays = 4}}).size(),
        components_of(channel) * 37 * 37)
        << name_of(channel);
  }
  EXPECT_NEAR(bake_geometry(squares.surface, solid, of_solid, GeometryChannel::thickness)[18 * 37 + 18], 0.5,
              1e-6);
  const ScalarImage scalar = scalar_image(37, heights, {0, 0.2}, 8);
  EXPECT_EQ(scalar.image.bytes[18 * 37 + 18], 128);
  EXPECT_EQ(normal_map_image(37, up).value(18, 18, 2), 1);
  EXPECT_EQ(normal_map_image(squares.surface, up, 16).bits, 16u);
}

TEST(SmokeBake, TangentSpaceNormalsOfTheSurfaceItselfAreStraightUp) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  const Mesh mesh = torus(9, 7);
  const Surface surface(mesh, {.kind = AtlasKind::uv, .resolution = 61});
  const Sites sites(mesh);
  const MeshAttribute normals = smooth_normals(mesh, 180), frame = tangents(surface, normals);
  ASSERT_EQ(frame.components, 4u);
  for (const Triangle& rows : *frame.rows)
    for (const std::uint32_t row : rows) {
      const float* const t = &frame.values[4 * row];
      EXPECT_NEAR(norm(Vec3{t[0], t[1], t[2]}), 1, 1e-5);
      EXPECT_EQ(std::abs(t[3]), 1);
    }
  const TexelMatches matches = match_texels(surface, sites);
  const std::vector<float> in_space =
      tangent_space_normals(surface, normals, frame, matched_normals(surface, sites, matches, normals));
  for (const std::uint32_t t : test::owned_texels(surface)) EXPECT_GT(in_space[3 * t + 2], 0.999);
  const std::vector<float> same =
      bake_geometry(surface, sites, matches, GeometryChannel::normal,
                    {.normals = &normals, .drawn_normals = &normals, .drawn_tangents = &frame});
  EXPECT_NEAR(same[3 * surface.sample_texels()[9] + 2], in_space[3 * surface.sample_texels()[9] + 2], 1e-6);
  EXPECT_GT(smooth_normals(cube(), kDrawnCrease).values.size(), smooth_normals(cube()).values.size());
}

TEST(SmokeBake, SamplesOfTexelsAreAveraged) {
  EXPECT_EQ(sample_side(9), 3u);
  EXPECT_FALSE(sample_side(8));
  const AtlasOptions texels{.resolution = 32, .gutter = 1};
  EXPECT_EQ(sample_layout(texels, 3).resolution, 96u);
  const SampleGrid grid{.resolution = 6, .side = 3};
  EXPECT_EQ(grid.texels(), 2u);
  std::vector<float> samples(36), directions(108);
  std::vector<std::uint32_t> numbers(36, 5);
  for (std::size_t i = 0; i < 36; ++i) {
    samples[i] = static_cast<float>(i % 6);
    directions[3 * i + i % 2] = 1;
    numbers[i] = i % 6 < 3 ? i % 2 : kNone;
  }
  samples[0] = std::nanf("");
  const TexelMeans means = mean_of_samples(grid, 1, samples);
  EXPECT_NEAR(means.values[1], 4, 1e-6);
  EXPECT_NEAR(means.coverage[0], 8.0 / 9, 1e-6);
  EXPECT_NEAR(means.values[0], 9.0 / 8, 1e-6);
  const TexelMeans directed = mean_of_samples(grid, 3, directions, SampleKind::directions);
  EXPECT_NEAR(norm(Vec3{directed.values[0], directed.values[1], directed.values[2]}), 1, 1e-6);
  const std::vector<std::uint32_t> most = most_frequent_samples(grid, numbers);
  EXPECT_EQ(most[1], kNone);
  EXPECT_EQ(most[0], 0u);
}

}  // namespace
}  // namespace sdm::test
