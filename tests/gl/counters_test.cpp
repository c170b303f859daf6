// The options of <sdm/gl.h> change the counters of the report, but no bit of the map.
#include "gl/raster_report.h"
#include "gl/scenes.h"
#include "gl/support.h"
#include "support/map_checks.h"
#include "support/points.h"

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
                         testing::Values("BoxAroundFigure", "FigureInBox", "WithDefects", "Soup",
                                         "CoplanarContact", "Identical", "SmallDetailFarAway"),
                         [](const auto& scene) { return scene.param; });

TEST_P(Counters, BoundCullingReducesWorkAndKeepsEveryBit) {
  const Pair pair(GetParam());
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    const GlOptions with{.clip = clip}, without{.clip = clip, .bound_culling = false};
    const test::GlMap culled = gl_map(pair.surface, pair.sites, with);
    const test::GlMap all = gl_map(pair.surface, pair.sites, without);
    EXPECT_TRUE(test::identical(culled, all));
    test::expect_laws(culled.report, pair.surface, pair.sites, with);
    test::expect_laws(all.report, pair.surface, pair.sites, without);
    EXPECT_EQ(culled.report.pairs, all.report.pairs);
    EXPECT_GT(culled.report.culled_by_bound, 0u);
    EXPECT_LE(culled.report.polygons, all.report.polygons);
    EXPECT_LE(culled.report.fragments, all.report.fragments);
  }
}

// Both draw the same distances; of sites that tie to rounding, either may win.
TEST_P(Counters, StencilAndPlanesGiveTheSameDistances) {
  const Pair pair(GetParam());
  const test::GlMap planes = gl_map(pair.surface, pair.sites, {.clip = GlClip::planes});
  const test::GlMap stencil = gl_map(pair.surface, pair.sites, {.clip = GlClip::stencil});
  test::Disagreements distances(2e-6 * test::scene_diagonal(pair.surface.mesh(), pair.sites.mesh()));
  for (const std::uint32_t t : pair.surface.sample_texels())
    distances.compare(t, stencil.distance[t], planes.distance[t]);
  EXPECT_TRUE(distances.none());
}

// An LRU cache of more values holds at any time all that one of fewer holds, so misses can only become fewer.
TEST(Stencil, FewerValuesMissMoreAndKeepEveryBit) {
  for (const char* name : {"CoplanarContact", "Needles", "OnOneTriangle", "TinyBesideLarge"}) {
    SCOPED_TRACE(name);
    const Pair pair(name);
    std::optional<test::GlMap> fewer;
    for (const int values : {1, 2, 7, 255}) {
      SCOPED_TRACE(values);
      const GlOptions options{.clip = GlClip::stencil, .stencil_values = values};
      test::GlMap map = gl_map(pair.surface, pair.sites, options);
      test::expect_laws(map.report, pair.surface, pair.sites, options);
      if (fewer) {
        EXPECT_TRUE(test::identical(*fewer, map));
        EXPECT_EQ(map.report.stencil_lookups, fewer->report.stencil_lookups);
        EXPECT_LE(map.report.stencil_misses, fewer->report.stencil_misses);
        EXPECT_EQ(map.report.polygons, fewer->report.polygons);
        EXPECT_EQ(map.report.fragments, fewer->report.fragments);
      }
      fewer = std::move(map);
    }
  }
}

// The cache evicts if there are more faces than values, and only then.
TEST(Stencil, EvictsOnlyWhenFull) {
  const Pair many("BoxAroundFigure");  // 12 faces
  const auto report = [](const Pair& pair, int values) {
    return gl_map(pair.surface, pair.sites, {.clip = GlClip::stencil, .stencil_values = values}).report;
  };
  EXPECT_EQ(report(many, 12).stencil_evictions, 0u);
  EXPECT_EQ(report(many, 12).stencil_misses, 12u);
  EXPECT_GT(report(many, 11).stencil_evictions, 0u);
  EXPECT_GT(report(Pair("LargeMap"), 255).stencil_evictions, 0u);
}

TEST_P(Counters, AreDeterministicForAnyThreadCount) {
  const Pair pair(GetParam());
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    const test::GlMap first = gl_map(pair.surface, pair.sites, {.clip = clip});
    const test::GlMap second = gl_map(pair.surface, pair.sites, {.clip = clip});
    EXPECT_TRUE(test::identical(first, second));
    test::expect_same_counts(first.report, second.report);
    const ThreadLimit one(1);
    const test::GlMap alone = gl_map(pair.surface, pair.sites, {.clip = clip});
    EXPECT_TRUE(test::identical(first, alone));
    test::expect_same_counts(first.report, alone.report);
  }
}

// The regions of a single triangle, its three edges and three vertices fill space without overlap: each texel
// is drawn once, except near the walls between them.
TEST(Counters, FragmentsOfOneTriangleCoverEachTexelOnce) {
  const Pair pair("OneTriangle");
  for (const bool bounds : {true, false}) {
    const gl::RasterReport r = gl_map(pair.surface, pair.sites, {.bound_culling = bounds}).report;
    EXPECT_EQ(r.sites, 7u);
    EXPECT_EQ(r.sites_dropped, 0u);
    EXPECT_LT(static_cast<double>(r.fragments), 1.02 * static_cast<double>(r.texels));
  }
}

// Of a box's edges the six diagonals of its sides lie between coplanar faces: nothing is closest to them.
TEST(Counters, SitesBetweenCoplanarFacesAreDropped) {
  const Pair pair("FigureInBox");
  const gl::RasterReport r = gl_map(pair.surface, pair.sites).report;
  EXPECT_EQ(r.sites, 12u + 18u + 8u);
  EXPECT_EQ(r.sites_dropped, 6u);
}

// The number of pairs is the product of the sizes of both meshes; the work must grow more slowly.
TEST(Counters, BoundsCullAlmostAllPairsOfLargeMeshes) {
  const Pair pair("Apart");
  const gl::RasterReport r = gl_map(pair.surface, pair.sites).report;
  EXPECT_GT(r.pairs, 1000000000u);
  EXPECT_LT(static_cast<double>(r.polygons), 1e-3 * static_cast<double>(r.pairs));
}

}  // namespace
}  // namespace sdm
