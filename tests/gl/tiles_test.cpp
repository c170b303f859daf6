// Tiles partition the owned texels; their domains and bounds are valid for every sample.
#include "surface/tiles.h"
#include "gl/face_domains.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "gl/domain_tree.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::gl {
namespace {

struct Scene {
  std::string name;
  Mesh o1, o2;
  AtlasKind kind = AtlasKind::charts;
};

std::vector<Scene> scenes() {
  std::mt19937 random(4);
  return {{"cow", test::load("cow.off", "fit"), test::load("head.off", "fit,translate:0.3:0:0")},
          {"box", test::cube(2), test::load("bones.off", "fit")},
          {"triangles", test::sphere(3), test::cube(0.4), AtlasKind::triangles},
          {"soup", test::soup(80, random), test::soup(50, random)}};
}

TEST(Tiles, PartitionTheOwnedTexels) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const Surface surface(scene.o1, {.kind = scene.kind, .resolution = 256});
    const TileTree tile_tree(surface);
    const surface::Tiles& tiles = tile_tree.tiles;
    std::vector<std::uint32_t> all(tiles.texels),
        owned(surface.sample_texels().begin(), surface.sample_texels().end());
    std::erase_if(owned, [&](std::uint32_t texel) { return texel >= surface.texel_faces().size(); });
    std::ranges::sort(all);
    std::ranges::sort(owned);
    EXPECT_EQ(all, owned);
    std::set<std::uint32_t> leaves;
    for (const tree::AabbTree::Node& node : tile_tree.tree.nodes)
      if (node.leaf()) {
        EXPECT_EQ(node.count, 1u);
        leaves.insert(tile_tree.tree.items[node.first]);
      }
    EXPECT_EQ(leaves.size(), tiles.count());
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
      std::uint32_t lo[2] = {kNone, kNone}, hi[2] = {0, 0};
      ASSERT_FALSE(tiles.of(tile).empty());
      for (const std::uint32_t texel : tiles.of(tile)) {
        EXPECT_EQ(surface.map_faces()[texel], tiles.faces[tile]);
        const std::uint32_t at[2] = {texel % 256, texel / 256};
        for (int k = 0; k < 2; ++k) {
          lo[k] = std::min(lo[k], at[k]);
          hi[k] = std::max(hi[k], at[k]);
        }
      }
      for (int k = 0; k < 2; ++k) EXPECT_LT(hi[k] - lo[k], surface::Tiles::kSide);
    }
  }
}

TEST(Tiles, DomainsContainTheirSamples) {
  for (const Scene& scene : scenes())
    for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
      SCOPED_TRACE(scene.name);
      const Surface surface(scene.o1, {.kind = scene.kind, .resolution = 256});
      const surface::Tiles tiles(surface, surface.texel_faces(), surface::Tiles::kSide);
      const UnitFrame frame = UnitFrame::of(bounds(scene.o2));
      for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const PlanarDomain domain = face_domain(surface, tiles, tile, frame, clip);
        ASSERT_EQ(domain.id, tiles.faces[tile]);
        for (const std::uint32_t texel : tiles.of(tile)) {
          const std::uint32_t column = texel % 256, row = texel / 256;
          const Vec2 centre{column + 0.5, row + 0.5};
          ASSERT_NEAR(norm(domain.point(centre) - frame.to_unit(surface.texel_point(texel))), 0, 1e-12);
          // Inside by the margin, which exceeds the rasteriser's displacement of a side, up to rounding.
          const std::span<const Vec2> corners = domain.outline.corners();
          ASSERT_GE(corners.size(), 3u);
          double turn = 0;
          for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec2 side = corners[(i + 1) % corners.size()] - corners[i];
            const double length = std::sqrt(dot(side, side));
            if (length < 1e-9) continue;
            const double height = cross(side, centre - corners[i]) / length;
            if (turn == 0) turn = height > 0 ? 1 : -1;
            ASSERT_GT(turn * height, 0.999 * kMargin);
          }
        }
      }
    }
}

TEST(Tiles, BoundsHoldForEverySample) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const Surface surface(scene.o1, {.kind = scene.kind, .resolution = 128});
    const Sites sites(scene.o2);
    const TileTree tile_tree(surface);
    const surface::Tiles& tiles = tile_tree.tiles;
    DomainTree tree(surface, tile_tree, internals(sites).frame);
    set_bounds(tree, internals(sites), 0, 1e9);
    for (std::uint32_t i = 0; i < tree.tree.nodes.size(); ++i) {
      const tree::AabbTree::Node& node = tree.tree.nodes[i];
      if (!node.leaf()) {
        EXPECT_EQ(tree.bound[i], std::max(tree.bound[i + 1], tree.bound[node.right]));
        continue;
      }
      std::vector<Vec3> points;
      for (const std::uint32_t texel : tiles.of(tree.tree.items[node.first]))
        points.push_back(surface.texel_point(texel));
      double farthest = 0;
      for (const ClosestPoint& c : closest_points(sites, points, {.engine = make_engine("reference")}))
        farthest = std::max(farthest, internals(sites).frame.scale * c.distance);
      EXPECT_LE(farthest, tree.bound[i]);
    }
  }
}

TEST(TileTreeCache, TracksMovedAndReplacedSurfaces) {
  TileTreeCache cache;
  Surface cow(test::load("cow.off", "fit"), {.resolution = 128});
  const std::uint32_t tiles = cache.of(cow).tiles.count();
  const TileTree* kept = &cache.of(cow);
  cow.refit(test::load("cow.off", "fit,scale:2").positions);
  Surface moved = std::move(cow);
  EXPECT_EQ(&cache.of(moved), kept);
  const Surface pig(test::load("pig.off", "fit"), {.resolution = 128});
  EXPECT_EQ(cache.of(pig).tiles.count(), TileTree(pig).tiles.count());
  EXPECT_EQ(&cache.of(moved), kept);
  // Another surface at the address of one that no longer exists.
  moved = Surface(test::load("pig.off", "fit"), {.resolution = 256});
  EXPECT_EQ(cache.of(moved).tiles.count(), TileTree(moved).tiles.count());
  EXPECT_NE(cache.of(moved).tiles.count(), tiles);
}

}  // namespace
}  // namespace sdm::gl
