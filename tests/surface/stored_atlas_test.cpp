#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/surface.h>

#include <algorithm>
#include <vector>

#include "support/error_of.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

TEST(StoredAtlas, GivesTheSameSurface) {
  const Mesh meshes[] = {test::load("head.off", "fit"), test::cube()};
  for (const Mesh& mesh : meshes)
    for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
      const AtlasOptions options{.kind = kind, .resolution = 300, .max_stretch = 1.7, .gutter = 2};
      const Surface first(mesh, options);
      const Surface second(mesh, options, first.stored_atlas());
      EXPECT_TRUE(std::ranges::equal(first.texel_faces(), second.texel_faces()));
      EXPECT_TRUE(std::ranges::equal(first.sample_texels(), second.sample_texels()));
      EXPECT_TRUE(std::ranges::equal(first.face_charts(), second.face_charts()));
      EXPECT_EQ(first.sample_points(), second.sample_points());
      EXPECT_EQ(first.chart_count(), second.chart_count());
      EXPECT_EQ(first.max_stretch(), second.max_stretch());
      EXPECT_EQ(first.atlas_corners(0), second.atlas_corners(0));
      EXPECT_EQ(first.stored_atlas(), second.stored_atlas());
      const Sites sites(test::sphere(2));
      EXPECT_EQ(compute_map(first, sites).distance.size(), compute_map(second, sites).distance.size());
    }
}

TEST(StoredAtlas, IsRefusedForAnotherMeshOrOtherOptions) {
  const Mesh mesh = test::sphere(2);
  const Bytes bytes = Surface(mesh, {.resolution = 128}).stored_atlas();
  const auto error = [&](const Mesh& of, const AtlasOptions& options) {
    return test::error_of([&] { Surface(of, options, bytes); });
  };
  EXPECT_EQ(error(mesh, {.resolution = 128}), "");
  Mesh moved = mesh;
  moved.positions[7][1] += 1e-12;
  EXPECT_THAT(error(moved, {.resolution = 128}), HasSubstr("another mesh"));
  Mesh turned = mesh;
  std::ranges::rotate(turned.triangles[3], turned.triangles[3].begin() + 1);
  EXPECT_THAT(error(turned, {.resolution = 128}), HasSubstr("another mesh"));
  EXPECT_THAT(error(test::sphere(1), {.resolution = 128}), HasSubstr("another mesh"));
  EXPECT_THAT(error(mesh, {.resolution = 256}), HasSubstr("resolution of 128"));
  EXPECT_THAT(error(mesh, {.resolution = 128, .gutter = 2}), HasSubstr("gutter of 1"));
  EXPECT_THAT(error(mesh, {.resolution = 128, .max_stretch = 2}), HasSubstr("other options"));
  EXPECT_THAT(error(mesh, {.kind = AtlasKind::triangles, .resolution = 128}), HasSubstr("other options"));
}

TEST(StoredAtlas, IsRefusedIfDamaged) {
  const Mesh mesh = test::tetrahedron();
  const AtlasOptions options{.resolution = 16};
  const Bytes bytes = Surface(mesh, options).stored_atlas();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(Surface(mesh, options, std::span(bytes).first(size)), Error) << size;
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_THROW(Surface(mesh, options, longer), Error);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes changed = bytes;
    changed[i] ^= 0x41;
    EXPECT_THROW(Surface(mesh, options, changed), Error) << i;
  }
}

}  // namespace
}  // namespace sdm
