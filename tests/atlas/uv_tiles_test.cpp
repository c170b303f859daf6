// Texture coordinates outside of the unit square: tiles, and faces cut along their borders.
#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/sdm.h>

#include <cmath>
#include <limits>
#include <random>

#include "atlas/invariants.h"
#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

Mesh with_uvs(Mesh mesh, double scale, const Vec2& offset) {
  for (auto& face : mesh.corner_uvs)
    for (auto& [u, v] : face) {
      u = scale * u + offset[0];
      v = scale * v + offset[1];
    }
  return mesh;
}

double area(const Mesh& mesh, const Triangle& t) {
  return 0.5 * norm(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                          mesh.positions[t[2]] - mesh.positions[t[0]]));
}

/// The texture coordinates of a point of a face.
Vec2 uv_at(const Mesh& mesh, std::uint32_t face, const Vec3& p) {
  const Triangle& t = mesh.triangles[face];
  const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3 normal = cross(b - a, c - a);
  const double whole = squared_norm(normal);
  const double second = dot(cross(c - a, a - p), normal) / whole,
               third = dot(cross(a - p, b - a), normal) / whole;
  const auto& uv = mesh.corner_uvs[face];
  return (1 - second - third) * uv[0] + second * uv[1] + third * uv[2];
}

// Each piece is a part of its face, with its orientation; together they have its area. A texel is where the
// texture, repeated, shows it.
void expect_wrapped(const Mesh& mesh) {
  const WrappedUvs wrapped = wrap_uvs(mesh, uv_tiles(mesh));
  ASSERT_EQ(wrapped.source_face.size(), wrapped.mesh.triangles.size());
  ASSERT_EQ(wrapped.mesh.corner_uvs.size(), wrapped.mesh.triangles.size());
  std::vector<double> areas(mesh.triangles.size());
  for (std::uint32_t f = 0; f < wrapped.source_face.size(); ++f) {
    const std::uint32_t source = wrapped.source_face[f];
    if (f < mesh.triangles.size()) {
      ASSERT_EQ(source, f);
    }
    areas[source] += area(wrapped.mesh, wrapped.mesh.triangles[f]);
    for (int k = 0; k < 3; ++k) {
      const Vec2& uv = wrapped.mesh.corner_uvs[f][k];
      const Vec2 original = uv_at(mesh, source, wrapped.mesh.positions[wrapped.mesh.triangles[f][k]]);
      for (int axis = 0; axis < 2; ++axis) {
        ASSERT_TRUE(uv[axis] >= 0 && uv[axis] <= 1);
        const double tiles = original[axis] - uv[axis];
        ASSERT_NEAR(tiles, std::round(tiles), 2e-6);
      }
    }
  }
  for (std::uint32_t f = 0; f < areas.size(); ++f)
    ASSERT_NEAR(areas[f], area(mesh, mesh.triangles[f]), 1e-9 * (1 + areas[f])) << f;

  const Surface surface(wrapped.mesh, {.kind = AtlasKind::uv, .resolution = 64});
  test::expect_samples(surface);
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const std::uint32_t source = wrapped.source_face[surface.map_faces()[texel]];
    const Vec2 uv = uv_at(mesh, source, surface.texel_point(texel));
    const Vec2 expected{(texel % 64 + 0.5) / 64, 1 - (texel / 64 + 0.5) / 64};
    for (int axis = 0; axis < 2; ++axis)
      ASSERT_NEAR(uv[axis] - expected[axis], std::round(uv[axis] - expected[axis]), 1e-5);
  }
}

TEST(UvTiles, CoordinatesAreWrapped) {
  const Mesh plane = test::height_field(12);
  EXPECT_TRUE(uv_tiles(plane).is_unit_square());
  const Mesh shifted = with_uvs(plane, 1, {-3, 7});
  EXPECT_EQ(wrap_uvs(shifted, uv_tiles(shifted)).cut_faces, 0u);
  expect_wrapped(shifted);
  for (const double scale : {1.0, 2.7, 13.3})
    for (const Vec2& offset : {Vec2{0.31, 0}, Vec2{-0.77, 4.1}})
      expect_wrapped(with_uvs(plane, scale, offset));
}

TEST(UvTiles, FacesMayCrossManyBorders) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-3, 3);
  Mesh mesh = test::soup(60, random);
  mesh.corner_uvs.clear();
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    auto& uvs = mesh.corner_uvs.emplace_back();
    for (auto& [u, v] : uvs) {
      u = place(random);
      v = place(random);
    }
    if (f % 3 == 0) uvs[0] = {std::round(uvs[0][0]), std::round(uvs[0][1])};  // corners on borders
    if (f % 5 == 0) uvs[1] = {uvs[0][0], uvs[1][1]};                          // and edges along them
  }
  expect_wrapped(mesh);
}

TEST(UvTiles, OfUdimAreTexturesOfTheirOwn) {
  const Mesh mesh = with_uvs(test::height_field(10), 2, {8, 3});
  const UvTiles tiles = uv_tiles(mesh);
  EXPECT_TRUE(tiles.is_udim());
  ASSERT_EQ(tiles.tiles.size(), 4u);
  EXPECT_EQ(tiles.tiles[0].udim(), 1039);
  EXPECT_EQ(tiles.tiles[1].udim(), 1040);
  EXPECT_EQ(tiles.tiles[2].udim(), 1049);
  std::size_t faces = 0;
  for (const UvTile& tile : tiles.tiles) {
    const Mesh part = uv_tile_mesh(mesh, tile);
    faces += part.triangles.size();
    const Surface surface(part, {.kind = AtlasKind::uv, .resolution = 64});
    EXPECT_EQ(surface.utilisation(), 1);
    EXPECT_EQ(part.positions, mesh.positions);
  }
  EXPECT_EQ(faces, mesh.triangles.size());
  EXPECT_FALSE(uv_tiles(with_uvs(test::height_field(10), 2, {9, 0})).is_udim()) << "u beyond 10";
  EXPECT_FALSE(uv_tiles(with_uvs(test::height_field(10), 2, {0, -1})).is_udim());
  EXPECT_FALSE(uv_tiles(with_uvs(test::height_field(10), 2, {0.5, 0})).is_udim()) << "faces cross borders";
}

TEST(UvTiles, RoundingCrossesNoBorder) {
  Mesh mesh = with_uvs(test::height_field(10), 1, {0, 0});
  mesh.corner_uvs[3][0][0] -= 1e-7;
  mesh.corner_uvs[5][1][1] += 1e-7;
  EXPECT_TRUE(uv_tiles(mesh).is_unit_square());
}

// Regression: a face with all corners at u = 1 was in the tile beside the unit square.
TEST(UvTiles, FacesOnABorderAreWithTheOthers) {
  const auto with_face = [](std::array<Vec2, 3> uvs, const Vec2& offset) {
    Mesh mesh = with_uvs(test::height_field(4), 1, offset);
    for (Vec2& uv : uvs) uv = uv + offset;
    mesh.triangles.push_back(mesh.triangles[0]);
    mesh.corner_uvs.push_back(uvs);
    return mesh;
  };
  constexpr std::array<std::array<Vec2, 3>, 5> kOnBorders{{{{{1, 0}, {1, 0}, {1, 1}}},
                                                           {{{1, 1}, {1, 1}, {1, 1}}},
                                                           {{{0, 0}, {0, 1}, {0, 0.5}}},
                                                           {{{0.2, 1}, {0.8, 1}, {0.3, 1}}},
                                                           {{{0, 1}, {0, 1}, {0, 1}}}}};
  for (const auto& uvs : kOnBorders) {
    EXPECT_TRUE(uv_tiles(with_face(uvs, {0, 0})).is_unit_square());
    const Mesh mesh = with_face(uvs, {3, 2});
    const UvTiles tiles = uv_tiles(mesh);
    ASSERT_EQ(tiles.tiles.size(), 1u);
    EXPECT_EQ(tiles.tiles[0].u, 3);
    EXPECT_EQ(tiles.tiles[0].v, 2);
    EXPECT_EQ(tiles.tiles[0].faces.size(), mesh.triangles.size());
  }
}

TEST(UvTiles, ATextureMayRepeatOftenOnFewFaces) {
  Mesh two{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  two.corner_uvs = {{{{0, 0}, {100, 0}, {100, 100}}}, {{{0, 0}, {100, 100}, {0, 100}}}};
  const Mesh wrapped = wrap_uvs(two, uv_tiles(two)).mesh;
  EXPECT_NEAR(static_cast<double>(wrapped.triangles.size()), 20000, 100);  // and slivers by rounding
  double texture = 0;
  for (const auto& [a, b, c] : wrapped.corner_uvs) texture += 0.5 * std::abs(cross(b - a, c - a));
  EXPECT_NEAR(texture, 10000, 1e-8);
}

// Faces that all have the whole texture: their texels are counted before any is visited.
TEST(UvTiles, FacesThatCoverTheTextureTooOftenAreRefused) {
  Mesh mesh = test::height_field(60);
  mesh.corner_uvs.assign(mesh.triangles.size(), {{{0, 0}, {1, 0}, {0, 1}}});
  const AtlasOptions options{.kind = AtlasKind::uv, .resolution = 16};
  EXPECT_EQ(Surface(mesh, options).mesh().triangles.size(), mesh.triangles.size());
  EXPECT_THAT(
      [&] { (void)Surface(mesh, {.kind = AtlasKind::uv, .resolution = 1024}); },
      ThrowsMessage<Error>(AllOf(HasSubstr("cover the texture"), HasSubstr("use an atlas of charts"))));
}

TEST(UvTiles, ImpossibleCoordinatesAreErrors) {
  Mesh mesh = test::height_field(4);
  const Mesh far_away = with_uvs(mesh, 3e5, {0.5, 0.5});
  EXPECT_THAT([&] { (void)wrap_uvs(far_away, uv_tiles(far_away)); },
              ThrowsMessage<Error>(HasSubstr("repeats too often")));
  // Two triangles in a strip of tiles, and in a square of them.
  Mesh two{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  for (const double height : {1.0, 999999.0}) {
    two.corner_uvs = {{{{0, 0}, {999999, 0}, {999999, height}}}, {{{0, 0}, {999999, height}, {0, height}}}};
    EXPECT_THAT([&] { (void)wrap_uvs(two, uv_tiles(two)); },
                ThrowsMessage<Error>(HasSubstr(" of them of face 0, where at most 65568 are possible")));
  }
  mesh.corner_uvs[2][0][0] = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { (void)uv_tiles(mesh); }, ThrowsMessage<Error>(HasSubstr("face 2 are beyond")));
  mesh.corner_uvs.clear();
  EXPECT_THAT([&] { (void)uv_tiles(mesh); }, ThrowsMessage<Error>(HasSubstr("not every corner")));
}

}  // namespace
}  // namespace sdm
