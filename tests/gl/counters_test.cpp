// What the options of <sdm/gl.h> change: counters, and never a bit of the map.
#include "gl/support.h"

namespace sdm {
namespace {

using test::gl_map;

struct Pair {
  explicit Pair(const char* name) : Pair(test::scene(name)) {}
  explicit Pair(const test::Scene& scene) : surface(scene.o1(), scene.atlas), sites(scene.o2()) {}
  Surface surface;
  Sites sites;
};

class Counters : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Counters,
                         testing::Values("BoxAroundFigure", "FigureInBox", "Spoilt", "Soup",
                                         "CoplanarContact", "Identical", "SmallDetailFarAway"),
                         [](const auto& scene) { return scene.param; });

TEST_P(Counters, BoundsSaveWorkAndChangeNoBit) {
  const Pair pair(GetParam());
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    const GlOptions with{.clip = clip}, without{.clip = clip, .bound_culling = false};
    const DistanceMap culled = gl_map(pair.surface, pair.sites, with);
    const DistanceMap all = gl_map(pair.surface, pair.sites, without);
    EXPECT_TRUE(test::identical(culled, all));
    test::expect_laws(*culled.raster, pair.surface, pair.sites, with);
    test::expect_laws(*all.raster, pair.surface, pair.sites, without);
    EXPECT_EQ(culled.raster->pairs, all.raster->pairs);
    EXPECT_GT(culled.raster->culled_by_bound, 0u);
    EXPECT_LE(culled.raster->polygons, all.raster->polygons);
    EXPECT_LE(culled.raster->fragments, all.raster->fragments);
  }
}

// Both draw the same distances; of sites that tie to rounding, either may win.
TEST_P(Counters, StencilAndPlanesFindTheSameDistances) {
  const Pair pair(GetParam());
  const DistanceMap planes = gl_map(pair.surface, pair.sites, {.clip = GlClip::planes});
  const DistanceMap stencil = gl_map(pair.surface, pair.sites, {.clip = GlClip::stencil});
  test::Disagreements distances(2e-6 * test::scene_diagonal(pair.surface.mesh(), pair.sites.mesh()));
  for (const std::uint32_t t : pair.surface.sample_texels())
    distances.compare(t, stencil.distance[t], planes.distance[t]);
  EXPECT_TRUE(distances.none());
}

// An LRU cache of more values holds at any time all that one of fewer holds, so misses can only become fewer.
TEST(Stencil, FewerValuesMissMoreAndChangeNoBit) {
  for (const char* name : {"CoplanarContact", "Needles", "OnOneTriangle", "TinyBesideLarge"}) {
    SCOPED_TRACE(name);
    const Pair pair(name);
    std::optional<DistanceMap> fewer;
    for (const int values : {1, 2, 7, 255}) {
      SCOPED_TRACE(values);
      const GlOptions options{.clip = GlClip::stencil, .stencil_values = values};
      DistanceMap map = gl_map(pair.surface, pair.sites, options);
      test::expect_laws(*map.raster, pair.surface, pair.sites, options);
      if (fewer) {
        EXPECT_TRUE(test::identical(*fewer, map));
        EXPECT_EQ(map.raster->stencil_lookups, fewer->raster->stencil_lookups);
        EXPECT_LE(map.raster->stencil_misses, fewer->raster->stencil_misses);
        EXPECT_EQ(map.raster->polygons, fewer->raster->polygons);
        EXPECT_EQ(map.raster->fragments, fewer->raster->fragments);
      }
      fewer = std::move(map);
    }
  }
}

// With more faces than values, the cache has to evict; with fewer, never.
TEST(Stencil, EvictsOnlyWhenFull) {
  const Pair many("BoxAroundFigure");  // 12 faces
  const auto report = [](const Pair& pair, int values) {
    return *gl_map(pair.surface, pair.sites, {.clip = GlClip::stencil, .stencil_values = values}).raster;
  };
  EXPECT_EQ(report(many, 12).stencil_evictions, 0u);
  EXPECT_EQ(report(many, 12).stencil_misses, 12u);
  EXPECT_GT(report(many, 11).stencil_evictions, 0u);
  EXPECT_GT(report(Pair("LargeMap"), 255).stencil_evictions, 0u);
}

TEST_P(Counters, DoNotDependOnThreadsOrRepetition) {
  const Pair pair(GetParam());
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    const DistanceMap first = gl_map(pair.surface, pair.sites, {.clip = clip});
    const DistanceMap second = gl_map(pair.surface, pair.sites, {.clip = clip});
    EXPECT_TRUE(test::identical(first, second));
    test::expect_same_counts(*first.raster, *second.raster);
    const ThreadLimit one(1);
    const DistanceMap alone = gl_map(pair.surface, pair.sites, {.clip = clip});
    EXPECT_TRUE(test::identical(first, alone));
    test::expect_same_counts(*first.raster, *alone.raster);
  }
}

// The regions of a single triangle, its three edges and three vertices fill space without overlap: each texel
// is drawn once, but next to the walls between them.
TEST(Fragments, OfOneTriangleCoverEachTexelOnce) {
  const Pair pair("OneTriangle");
  for (const bool bounds : {true, false}) {
    const GlReport r = *gl_map(pair.surface, pair.sites, {.bound_culling = bounds}).raster;
    EXPECT_EQ(r.sites, 7u);
    EXPECT_EQ(r.sites_dropped, 0u);
    EXPECT_LT(static_cast<double>(r.fragments), 1.02 * static_cast<double>(r.texels));
  }
}

// Of a box's edges the six diagonals of its sides lie between coplanar faces: nothing is closest to them.
TEST(Sites, BetweenCoplanarFacesAreDropped) {
  const Pair pair("FigureInBox");
  const GlReport r = *gl_map(pair.surface, pair.sites).raster;
  EXPECT_EQ(r.sites, 12u + 18u + 8u);
  EXPECT_EQ(r.sites_dropped, 6u);
}

// The pairs grow as the product of both meshes, the work must not.
TEST(Bounds, LeaveFewPolygonsOfLargeMeshes) {
  const Pair pair("Apart");
  const GlReport r = *gl_map(pair.surface, pair.sites).raster;
  EXPECT_GT(r.pairs, 1000000000u);
  EXPECT_LT(static_cast<double>(r.polygons), 1e-3 * static_cast<double>(r.pairs));
}

}  // namespace
}  // namespace sdm
