#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/sdm.h>

#include <algorithm>

#include "atlas/invariants.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const AtlasOptions kOptions{.kind = AtlasKind::uv, .resolution = 200};

TEST(Uv, UsesTheMeshesOwnCoordinates) {
  const Surface surface(test::height_field(30), kOptions);
  test::expect_charts(surface);
  test::expect_owners(surface);
  test::expect_maps(surface);
  test::expect_samples(surface);
  EXPECT_EQ(surface.chart_count(), 1u);
  EXPECT_EQ(surface.utilisation(), 1);
  const Vec3& p = surface.mesh().positions[surface.mesh().triangles[5][1]];
  const Vec2 uv = surface.to_atlas(5, p);
  EXPECT_NEAR(uv[0], p[0] * 200, 1e-9);
  EXPECT_NEAR(uv[1], (1 - p[1]) * 200, 1e-9);
}

TEST(Uv, TexelsNeedNotBeSquare) {
  for (const auto& [columns, rows] : {std::pair(200u, 50u), std::pair(33u, 700u)}) {
    AtlasOptions options = kOptions;
    options.resolution = columns;
    options.rows = rows;
    const Surface surface(test::height_field(30), options);
    ASSERT_EQ(surface.resolution(), columns);
    ASSERT_EQ(surface.rows(), rows);
    ASSERT_EQ(surface.texel_faces().size(), std::size_t{columns} * rows);
    test::expect_charts(surface);
    test::expect_owners(surface);
    test::expect_maps(surface);
    test::expect_samples(surface);
    EXPECT_EQ(surface.utilisation(), 1);
    const Vec3& p = surface.mesh().positions[surface.mesh().triangles[5][1]];
    const Vec2 uv = surface.to_atlas(5, p);
    EXPECT_NEAR(uv[0], p[0] * columns, 1e-9);
    EXPECT_NEAR(uv[1], (1 - p[1]) * rows, 1e-9);
    const auto [du, dv] = surface.texel_edges(5);
    EXPECT_NEAR(du[0] * columns, 1, 1e-9);
    EXPECT_NEAR(-dv[1] * rows, 1, 1e-9);
    options.strict_uv = true;
    EXPECT_NO_THROW(Surface(test::height_field(30), options));
    options.gutter = std::min(columns, rows) / 4 + 1;
    EXPECT_THROW(Surface(test::height_field(30), options), Error);
  }
  // A plane that is four times as wide as high: square texels without stretch.
  Mesh plane = test::height_field(4);
  for (Vec3& p : plane.positions) p = {4 * p[0], p[1], 0};
  EXPECT_NEAR(Surface(plane, {.kind = AtlasKind::uv, .resolution = 400, .rows = 100}).max_stretch(), 1,
              1e-12);
  EXPECT_NEAR(Surface(plane, kOptions).max_stretch(), 2, 1e-12);
}

TEST(Uv, OnlyOwnCoordinatesCanHaveAnotherShape) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
    EXPECT_THAT([&] { Surface(test::cube(), {.kind = kind, .resolution = 64, .rows = 32}); },
                ThrowsMessage<Error>(HasSubstr("texture coordinates")));
    EXPECT_EQ(Surface(test::cube(), {.kind = kind, .resolution = 64, .rows = 64}).rows(), 64u);
  }
  EXPECT_THROW(Surface(test::height_field(4), {.kind = AtlasKind::uv, .resolution = 64, .rows = 15}), Error);
  EXPECT_THROW((void)resolution_for(test::height_field(4), 0.1, {.kind = AtlasKind::uv, .rows = 15}), Error);
}

TEST(Uv, StoredAtlasesHaveTheirShape) {
  const Mesh mesh = test::height_field(9);
  AtlasOptions options = kOptions;
  options.rows = 70;
  const Surface surface(mesh, options);
  const Surface restored(mesh, options, surface.stored_atlas());
  EXPECT_EQ(restored.rows(), 70u);
  EXPECT_TRUE(std::ranges::equal(surface.texel_faces(), restored.texel_faces()));
  for (const std::uint32_t rows : {0u, 60u, 80u}) {
    options.rows = rows;
    EXPECT_THROW(Surface(mesh, options, surface.stored_atlas()), Error) << rows;
  }
}

// An edit of a wide atlas adds rows to it.
TEST(Uv, EditsKeepTheShape) {
  AtlasOptions options = kOptions;
  options.rows = 50;
  Surface surface(test::height_field(9), options);
  const std::vector<Triangle> copies(surface.mesh().triangles.begin(), surface.mesh().triangles.begin() + 20);
  surface.edit({.added_faces = copies});
  EXPECT_GT(surface.rows(), 50u);
  test::expect_maps(surface);
  test::expect_samples(surface);
  const Surface restored(surface.mesh(), options, surface.stored_atlas());
  EXPECT_EQ(restored.rows(), surface.rows());
}

TEST(Uv, StretchIsRelativeToTheScaleOfAll) {
  Mesh mesh = test::height_field(4);
  for (Vec3& p : mesh.positions) p = {2 * p[0], 0.5 * p[1], 0};
  EXPECT_NEAR(Surface(mesh, kOptions).max_stretch(), 2, 1e-12);
}

TEST(Uv, AcceptsMirroredAndSeparatePieces) {
  Mesh mesh = test::height_field(10);
  for (auto& face : mesh.corner_uvs)
    for (Vec2& uv : face) uv[0] = (1 - uv[0]) / 2;
  const std::size_t half = mesh.triangles.size() / 2;
  for (std::size_t f = half; f < mesh.triangles.size(); ++f)
    for (Vec2& uv : mesh.corner_uvs[f]) uv[0] += 0.5;
  const Surface surface(mesh, kOptions);
  EXPECT_EQ(surface.chart_count(), 2u);
  test::expect_owners(surface);
  test::expect_maps(surface);
}

// The first chart keeps its texels, and each face of the others has a sample of its own.
TEST(Uv, OverlappingTexelsBelongToTheFirstChart) {
  Mesh mesh = test::height_field(10);
  const Surface apart(mesh, kOptions);
  EXPECT_EQ(apart.overlapping_texels(), 0u) << "neighbours share edges only";
  const Mesh once = mesh;
  for (const Triangle& t : once.triangles) mesh.triangles.push_back({t[0] + 121, t[1] + 121, t[2] + 121});
  for (const Vec3& p : once.positions) mesh.positions.push_back({p[0], p[1], p[2] + 3});
  mesh.corner_uvs.insert(mesh.corner_uvs.end(), once.corner_uvs.begin(), once.corner_uvs.end());
  const Surface surface(mesh, kOptions);
  EXPECT_EQ(surface.chart_count(), 2u);
  EXPECT_TRUE(std::ranges::equal(surface.texel_faces(), apart.texel_faces()));
  EXPECT_EQ(surface.overlapping_texels(), 200u * 200 - 100 * 20) << "all but the centres on diagonals";
  EXPECT_EQ(surface.map_faces().size(), surface.texel_faces().size() + once.triangles.size());
  double longest = 0;
  for (const Triangle& t : once.triangles)
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, norm(once.positions[t[k]] - once.positions[t[(k + 1) % 3]]));
  EXPECT_LE(covering_radius(surface), longest);
  test::expect_samples(surface);

  const Surface restored(mesh, kOptions, surface.stored_atlas());
  EXPECT_EQ(restored.overlapping_texels(), surface.overlapping_texels());
  AtlasOptions strict = kOptions;
  strict.strict_uv = true;
  EXPECT_THROW(Surface(mesh, strict), Error);
  EXPECT_THROW(Surface(mesh, strict, surface.stored_atlas()), Error);
}

TEST(Uv, OverlapErrorNamesTheFaces) {
  Mesh mesh = test::height_field(10);
  mesh.corner_uvs[7] = {Vec2{0.97, 0.52}, Vec2{0.99, 0.52}, Vec2{0.98, 0.53}};
  AtlasOptions strict = kOptions;
  strict.strict_uv = true;
  EXPECT_THAT([&] { Surface(mesh, strict); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("faces 7 and 1"), HasSubstr("overlap"), HasSubstr("atlas of charts"))));
}

// Regression: one such face, as simplified UV spheres and artists' layouts have them, made all UVs unusable.
TEST(Uv, FacesWithoutAreaInTheTextureHaveOneSampleAndNoTexel) {
  Mesh mesh = test::height_field(10);
  mesh.corner_uvs[4][0] = mesh.corner_uvs[4][1];
  mesh.corner_uvs[7].fill({1, 1});
  mesh.corner_uvs[8] = {Vec2{1, 0.2}, Vec2{1, 0.8}, Vec2{1, 0.4}};
  mesh.corner_uvs[9].fill({0.5025, 0.5025});  // the centre of a texel
  for (const std::uint32_t rows : {200u, 50u}) {
    const Surface surface(mesh, {.kind = AtlasKind::uv, .resolution = 200, .rows = rows});
    test::expect_charts(surface);
    test::expect_owners(surface);
    test::expect_samples(surface);
    EXPECT_EQ(surface.faces_without_uv_area(), 4u);
    EXPECT_EQ(surface.chart_count(), 5u);
    EXPECT_LT(surface.max_stretch(), 10);
    const auto texels = surface.texel_faces(), all = surface.map_faces();
    for (const std::uint32_t f : {4u, 7u, 8u, 9u}) {
      EXPECT_EQ(std::ranges::count(texels, f), 0) << f;
      EXPECT_EQ(std::ranges::count(all, f), 1) << f;
      for (int k = 0; k < 3; ++k) {
        const Vec2 at = surface.atlas_corners(f)[k], uv = mesh.corner_uvs[f][k];
        EXPECT_NEAR(at[0], 200 * uv[0], 1.0 / 1024);
        EXPECT_NEAR(at[1], rows * (1 - uv[1]), 1.0 / 1024);
        EXPECT_TRUE(at[0] >= 0 && at[0] <= 200 && at[1] >= 0 && at[1] <= rows);
      }
    }
    // Every point of the surface is as close to a sample as the bound says, also after a refit.
    double longest = 0;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        longest = std::max(longest, norm(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
    EXPECT_LE(covering_radius(surface), longest);
    const Surface restored(mesh, {.kind = AtlasKind::uv, .resolution = 200, .rows = rows},
                           surface.stored_atlas());
    EXPECT_EQ(restored.faces_without_uv_area(), 4u);
  }
}

TEST(Uv, MissingOutsideAndCollapsedCoordinatesAreErrors) {
  Mesh mesh = test::height_field(10);
  const auto uvs = mesh.corner_uvs;
  mesh.corner_uvs.clear();
  EXPECT_THAT([&] { Surface(mesh, kOptions); }, ThrowsMessage<Error>(HasSubstr("not every corner")));
  mesh.corner_uvs = uvs;
  mesh.corner_uvs[9][1][0] = 1.2;
  EXPECT_THAT([&] { Surface(mesh, kOptions); }, ThrowsMessage<Error>(HasSubstr("face 9 lie outside")));
  mesh.corner_uvs = uvs;
  mesh.corner_uvs[4][0] = mesh.corner_uvs[4][1];
  AtlasOptions strict = kOptions;
  strict.strict_uv = true;
  EXPECT_THAT([&] { Surface(mesh, strict); }, ThrowsMessage<Error>(HasSubstr("face 4 has an area")));
}

}  // namespace
}  // namespace sdm
