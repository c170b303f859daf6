// Regions, their oriented boxes and clipping keep every closest point.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "closest/reference/reference_engine.h"
#include "gl/pair_culling.h"
#include "gl/polygons/oriented_box.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::gl {
namespace {

std::vector<std::pair<std::string, Mesh>> meshes() {
  std::mt19937 random(9);
  return {{"cube", test::cube()},
          {"cow", test::load("cow.off", "fit")},
          {"open", test::load("hole.off", "fit")},
          {"soup", test::soup(60, random)},
          {"triangle",
           Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}}}};
}

using SiteName = std::pair<SiteType, std::uint32_t>;

/// The regions of all sites with an interior.
std::map<SiteName, SiteRegion> regions_of(const sites::SitesData& sites) {
  std::map<SiteName, SiteRegion> regions;
  for (std::size_t leaf = 0; leaf + 1 < sites.regions.leaves.size(); ++leaf)
    for_each_site(sites.regions, leaf, [&](const auto& found, std::size_t index) {
      if (!has_interior(found)) return;
      const SiteRegion region = region_of(sites, found, index);
      using Region = std::decay_t<decltype(found)>;
      std::uint32_t site = region.face;
      if constexpr (std::is_same_v<Region, sites::EdgeRegion>) site = found.edge;
      if constexpr (std::is_same_v<Region, sites::VertexRegion>) site = found.vertex;
      EXPECT_TRUE(regions.emplace(SiteName{region.type, site}, region).second);
    });
  return regions;
}

bool inside(const OrientedBox& box, const Vec3& p) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(dot(box.axes[k], p - box.centre)) > box.half[k]) return false;
  return true;
}

TEST(Culling, RegionsAndBoxesContainTheClosestPoints) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    const auto regions = regions_of(internals(sites));
    const UnitFrame& frame = internals(sites).frame;
    std::mt19937 random(5);
    std::map<SiteType, int> seen;
    constexpr double kSlack = 4e-6;
    for (int i = 0; i < 4000; ++i) {
      const double half = i % 2 ? 1.2 : 4;
      const Vec3 unit = test::random_point({{-half, -half, -half}, {half, half, half}}, random);
      const Vec3 q = (1 / frame.scale) * unit + frame.origin;
      const ClosestPoint c = reference::reference_closest(internals(sites), q, 1e30);
      const auto found = regions.find({c.type, c.site});
      // An edge without a wedge may still be named, for a point over it to rounding: not by random points.
      ASSERT_TRUE(found != regions.end()) << static_cast<int>(c.type) << ' ' << c.site;
      ++seen[c.type];
      const SiteRegion& region = found->second;
      for (int k = 0; k < region.wall_count; ++k)
        ASSERT_GE(dot(region.walls[k].normal, unit), region.walls[k].offset - kSlack);
      ASSERT_NEAR(norm(region.distance_vector(unit) - (frame.to_unit(c.point) - unit)), 0, kSlack);
      const OrientedBox box = oriented_box(region, frame.scale * c.distance, kSlack);
      ASSERT_TRUE(inside(box, unit)) << static_cast<int>(c.type) << ' ' << c.site << " query " << i;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) ASSERT_NEAR(dot(box.axes[a], box.axes[b]), a == b, 1e-12);
    }
    for (const SiteType type : {SiteType::vertex, SiteType::edge, SiteType::face}) EXPECT_GT(seen[type], 20);
  }
}

TEST(Culling, OrientedBoxesOfNarrowRegionsAreNarrow) {
  // On a fine sphere wedges and cones are as narrow as the faces are small; wide boxes would cull
  // nothing.
  const Sites sites(test::sphere(4));
  for (const auto& [site, region] : regions_of(internals(sites))) {
    const OrientedBox box = oriented_box(region, 1, 0);
    std::array<double, 3> half = box.half;
    std::ranges::sort(half);
    EXPECT_LT(half[1], 0.2) << static_cast<int>(site.first) << " " << half[0] << " " << half[2] << " walls "
                            << region.wall_count;
    EXPECT_LE(half[2], 1.0);
  }
}

TEST(Culling, OverlappingBoxesAreNeverSeparated) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    OrientedBox box;
    const Vec3 a = normalized({unit(random), unit(random), unit(random)});
    const Vec3 b = normalized(cross(a, {unit(random), unit(random), unit(random)}));
    box.axes = {a, b, cross(a, b)};
    box.centre = {2 * unit(random), 2 * unit(random), 2 * unit(random)};
    box.half = {std::abs(unit(random)), std::abs(unit(random)), 0.3 * std::abs(unit(random))};
    Box other;
    extend(other, Vec3{unit(random), unit(random), unit(random)});
    extend(other, Vec3{unit(random), unit(random), unit(random)});
    const bool may = may_meet(box, tree::FloatBox::around(other));
    apart += !may;
    for (int k = 0; k < 20 && !may; ++k) {
      Vec3 p = box.centre;
      for (int axis = 0; axis < 3; ++axis) p += unit(random) * box.half[axis] * box.axes[axis];
      ASSERT_FALSE(contains(other, p));
    }
  }
  EXPECT_GT(apart, 2000);
}

TEST(ConvexPolygon, CutKeepsExactlyTheHalfPlane) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  int inside_count = 0, outside_count = 0;
  for (int i = 0; i < 3000; ++i) {
    ConvexPolygon polygon = ConvexPolygon::rectangle({-1, -1}, {1, 1});
    std::vector<HalfPlane> cuts;
    for (int k = 0; k < 7; ++k) {
      const double angle = 4 * unit(random);
      cuts.push_back({0.5 + 0.5 * unit(random), {std::cos(angle), std::sin(angle)}});
      polygon.cut(cuts.back());
    }
    const std::span<const Vec2> corners = polygon.corners();
    for (int k = 0; k < 20; ++k) {
      const Vec2 p{unit(random), unit(random)};
      double least = 1;
      for (const HalfPlane& cut : cuts) least = std::min(least, cut(p));
      if (std::abs(least) < 1e-9) continue;
      bool inside_polygon = !corners.empty();
      for (std::size_t c = 0; c < corners.size(); ++c)
        inside_polygon =
            inside_polygon && cross(corners[(c + 1) % corners.size()] - corners[c], p - corners[c]) > -1e-12;
      ASSERT_EQ(inside_polygon, least > 0);
      ++(inside_polygon ? inside_count : outside_count);
    }
  }
  EXPECT_GT(inside_count, 1000);
  EXPECT_GT(outside_count, 1000);
}

TEST(Blocks, PartitionTheTree) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 128});
  const TileTree tiles(surface);
  const DomainTree tree(surface, tiles, UnitFrame{});
  for (const std::uint32_t size : {1u, 7u, 255u, 1000000u}) {
    std::uint32_t leaves = 0, end = 0;
    for (const DomainBlock& block : cut_into_blocks(tree, size)) {
      EXPECT_EQ(tree.leaves.before[block.node], tree.leaves.before[end]);
      end = block.end;
      EXPECT_LE(tree.leaves.count(block.node, block.end), size);
      leaves += tree.leaves.count(block.node, block.end);
    }
    EXPECT_EQ(leaves, tiles.tiles.count());
  }
}

}  // namespace
}  // namespace sdm::gl
