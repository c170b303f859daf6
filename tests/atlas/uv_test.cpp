#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/sdm.h>

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

TEST(Uv, OverlapErrorNamesTheFaces) {
  Mesh mesh = test::height_field(10);
  mesh.corner_uvs[7] = {Vec2{0.97, 0.52}, Vec2{0.99, 0.52}, Vec2{0.98, 0.53}};
  EXPECT_THAT([&] { Surface(mesh, kOptions); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("faces 7 and 1"), HasSubstr("overlap"), HasSubstr("atlas of charts"))));
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
  EXPECT_THAT([&] { Surface(mesh, kOptions); }, ThrowsMessage<Error>(HasSubstr("face 4 has an area")));
}

}  // namespace
}  // namespace sdm
