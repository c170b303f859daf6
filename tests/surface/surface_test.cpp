#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/sampling_bound.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <set>
#include <vector>

#include "atlas/invariants.h"
#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

void expect_packed(const Surface& surface, const AtlasOptions& options) {
  test::expect_charts(surface);
  test::expect_owners(surface);
  test::expect_gutters(surface, options.gutter);
  test::expect_maps(surface);
  test::expect_samples(surface);
  EXPECT_LE(surface.max_stretch(), options.max_stretch);
}

class RealMeshes : public testing::TestWithParam<const char*> {};

TEST_P(RealMeshes, ChartsKeepTheInvariants) {
  const AtlasOptions options{.resolution = 512};
  const Surface surface(test::load(GetParam()), options);
  expect_packed(surface, options);
  test::expect_stretch(surface);
  EXPECT_LT(surface.chart_count(), surface.mesh().triangles.size() / 2 + 7);
}

INSTANTIATE_TEST_SUITE_P(Files, RealMeshes,
                         testing::Values("bunny.obj", "armadillo.off", "elephant-with-holes.off",
                                         "mannequin-devil.off", "double-torus-example.off", "holes.off",
                                         "knot1.off", "cube.off", "pinion.off", "turbine.off", "boeing.off",
                                         "degtri_sliding.off", "triceratops.off", "ChineseDragon-10kv.off"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
                           return name;
                         });

TEST(Charts, SoupsKeepTheInvariants) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const AtlasOptions options{.resolution = 700, .gutter = seed};
    expect_packed(Surface(test::degenerate_soup(400, seed), options), options);
  }
}

TEST(Charts, MoebiusStripsAndRampsAreCut) {
  const AtlasOptions options{.resolution = 256};
  const Surface strip(test::band(60, true), options);
  expect_packed(strip, options);
  const Surface ramp(test::spiral_ramp(5, 40), options);
  expect_packed(ramp, options);
  EXPECT_GE(ramp.chart_count(), 5u);  // all of it lies in one cone, and covers itself five times
}

TEST(Charts, AFanOfSliversIsOneChart) {
  const AtlasOptions options{.resolution = 256};
  const Surface surface(test::fan(3000), options);
  expect_packed(surface, options);
  EXPECT_EQ(surface.chart_count(), 1u);
}

TEST(Charts, GrowWithTheAllowedStretch) {
  std::size_t before = SIZE_MAX;
  for (const double stretch : {1.001, 1.05, 1.2, 2.0, 100.0}) {
    SCOPED_TRACE(stretch);
    const AtlasOptions options{.resolution = 512, .max_stretch = stretch};
    const Surface surface(test::load("hand.off"), options);
    expect_packed(surface, options);
    test::expect_stretch(surface);
    EXPECT_LE(surface.chart_count(), before);
    before = surface.chart_count();
  }
}

TEST(Charts, FillTheAtlas) {
  const Surface surface(test::load("bunny.obj"), {.resolution = 1024});
  EXPECT_GE(surface.utilisation(), 0.65);
  EXPECT_LE(surface.chart_count(), 600u);
}

// Cells of packing are several texels here.
TEST(Charts, HighResolutionsKeepTheInvariants) {
  const AtlasOptions options{.resolution = 2100, .gutter = 2};
  expect_packed(Surface(test::load("elephant.off"), options), options);
}

TEST(Charts, DoNotDependOnThreads) {
  const Mesh mesh = test::load("camel.off");
  const Surface parallel(mesh, {.resolution = 256});
  const ThreadLimit limit(1);
  const Surface serial(mesh, {.resolution = 256});
  EXPECT_TRUE(std::ranges::equal(parallel.texel_faces(), serial.texel_faces()));
  EXPECT_TRUE(std::ranges::equal(parallel.sample_texels(), serial.sample_texels()));
}

TEST(Charts, DoNotDependOnTheUnit) {
  Mesh mesh = test::load("camel.off");
  const Surface surface(mesh, {.resolution = 256});
  for (Vec3& p : mesh.positions) p = 0x1p-60 * p;
  const Surface tiny(mesh, {.resolution = 256});
  EXPECT_TRUE(std::ranges::equal(surface.texel_faces(), tiny.texel_faces()));
}

TEST(Triangles, AreIsometricAndKeepTheInvariants) {
  const AtlasOptions options{.kind = AtlasKind::triangles, .resolution = 1024};
  const Surface surface(test::load("double-torus-example.off"), options);
  expect_packed(surface, options);
  test::expect_stretch(surface);
  EXPECT_EQ(surface.max_stretch(), 1);
}

// A chart is a face or two; the two share an edge, and both map its ends to the same points.
TEST(Triangles, ArePairedAcrossAnEdge) {
  for (const char* file : {"double-torus-example.off", "elephant-with-holes.off"}) {
    SCOPED_TRACE(file);
    const Surface surface(test::load(file), {.kind = AtlasKind::triangles, .resolution = 1024});
    const std::vector<Triangle>& triangles = surface.mesh().triangles;
    std::vector<std::vector<std::uint32_t>> charts(surface.chart_count());
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
      if (const std::uint32_t chart = surface.face_charts()[f]; chart != kNone) charts[chart].push_back(f);
    for (const std::vector<std::uint32_t>& faces : charts) {
      ASSERT_LE(faces.size(), 2u);
      if (faces.size() < 2) continue;
      int common = 0;
      for (const std::uint32_t v : triangles[faces[0]]) {
        if (std::ranges::count(triangles[faces[1]], v) == 0) continue;
        ++common;
        const Vec3& p = surface.mesh().positions[v];
        const Vec2 gap = surface.to_atlas(faces[0], p) - surface.to_atlas(faces[1], p);
        EXPECT_LE(std::hypot(gap[0], gap[1]), 1e-6);
      }
      EXPECT_EQ(common, 2);
    }
    EXPECT_LE(surface.chart_count(), 0.55 * static_cast<double>(triangles.size()));
  }
}

// Faces that cannot be unfolded are charts of their own: neighbours across an edge of three faces, with
// another orientation, or across an edge so short that its direction is rounding.
TEST(Triangles, OfBranchesTurnedFacesAndNeedlesStaySingle) {
  const auto charts = [](std::vector<Vec3> positions, std::vector<Triangle> triangles) {
    const AtlasOptions options{.kind = AtlasKind::triangles, .resolution = 64};
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    const Surface surface(mesh, options);
    expect_packed(surface, options);
    EXPECT_EQ(surface.max_stretch(), 1);
    return surface.chart_count();
  };
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.5}, {0, 0, 1}};
  EXPECT_EQ(charts(points, {{0, 1, 2}, {1, 0, 3}}), 1u);
  EXPECT_EQ(charts(points, {{0, 1, 2}, {0, 1, 3}}), 2u);
  EXPECT_EQ(charts(points, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), 3u);
  EXPECT_EQ(charts(points, {{0, 1, 2}, {0, 2, 1}}), 2u);  // they share all three edges
  const double tiny = 1e-16;
  EXPECT_LE(charts({{1, 0, 0}, {1 + 2 * tiny, 0, 0}, {0, 1, 0}, {0, -1, 0.5}}, {{0, 1, 2}, {1, 0, 3}}), 2u);
}

TEST(Triangles, FillMostOfTheAtlas) {
  EXPECT_GE(Surface(test::load("head.off"), {.kind = AtlasKind::triangles}).utilisation(), 0.7);
}

// Faces are far smaller than texels: each chart still owns one.
TEST(Triangles, SmallOnesOwnATexel) {
  const AtlasOptions options{.kind = AtlasKind::triangles, .resolution = 256};
  expect_packed(Surface(test::load("pig.off"), options), options);
}

TEST(Samples, AreTheOwnedTexelsAndAPointOfEachOtherFace) {
  const Surface surface(test::load("pig.off"), {.resolution = 256});
  const auto samples = surface.sample_texels();
  const std::vector<Vec3> points = surface.sample_points();
  ASSERT_EQ(points.size(), samples.size());
  std::set<std::uint32_t> owned;
  for (std::uint32_t texel = 0; texel < surface.map_faces().size(); ++texel)
    if (surface.map_faces()[texel] != kNone) owned.insert(texel);
  EXPECT_EQ(std::set<std::uint32_t>(samples.begin(), samples.end()), owned);
  EXPECT_EQ(samples.size(), owned.size());
  for (std::size_t i = 0; i < samples.size(); ++i) ASSERT_EQ(points[i], surface.texel_point(samples[i]));
}

TEST(Samples, PacketsOfSixteenAreCompact) {
  const Surface surface(test::load("bunny.obj"), {.resolution = 512});
  const auto samples = surface.sample_texels();
  double sum = 0;
  std::size_t groups = 0;
  for (std::size_t i = 0; i + 16 <= samples.size(); i += 16, ++groups) {
    Box box;
    for (std::size_t k = i; k < i + 16; ++k) extend(box, surface.texel_point(samples[k]));
    sum += diagonal(box) / norm(surface.texel_edges(surface.map_faces()[samples[i]])[0]);
  }
  // A full 4×4 block has a diagonal of 3√2 texels; where the surface curves, or sheets are close, it is more.
  EXPECT_LT(sum / static_cast<double>(groups), 12);
}

TEST(Progress, CanCancel) {
  AtlasOptions options{.resolution = 256};
  options.progress = [](std::string_view, double fraction) { return fraction < 0.35; };
  EXPECT_THROW(Surface(test::load("cube.off"), options), Cancelled);
}

// Regression: every round of the packing was a step of its own, and the fraction went back.
TEST(Progress, IsOneStepThatNeverGoesBack) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles})
    for (const char* file : {"cube.off", "elephant-with-holes.off"})
      for (const std::uint32_t resolution : {64u, 512u}) {
        if (kind == AtlasKind::triangles && resolution == 64) continue;  // too small
        std::vector<double> fractions;
        AtlasOptions options{.kind = kind, .resolution = resolution};
        options.progress = [&](std::string_view step, double fraction) {
          EXPECT_EQ(step, "atlas");
          fractions.push_back(fraction);
          return true;
        };
        (void)Surface(test::load(file), options);
        EXPECT_TRUE(std::ranges::is_sorted(fractions)) << file << ' ' << resolution;
        EXPECT_EQ(fractions.front(), 0);
        EXPECT_EQ(fractions.back(), 1);
        EXPECT_GT(std::ranges::count_if(fractions, [](double f) { return f > 0.4 && f < 0.9; }), 2);
      }
}

// Texels move with the vertices of their faces.
TEST(SurfaceRefit, MovesTexelsWithTheirFaces) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
    Mesh mesh = test::load("bunny.obj");
    Surface surface(mesh, {.kind = kind, .resolution = 1024});
    const std::vector<Vec3> before = surface.sample_points();
    const std::vector<std::uint32_t> owners(surface.texel_faces().begin(), surface.texel_faces().end());
    SamplingBound bound(surface);
    const double first_bound = bound.value(), size = diagonal(bounds(mesh));

    // An affine motion moves every point of the surface by the same rule as the vertices.
    const auto moved = [](const Vec3& p) {
      return Vec3{2 * p[0] + 0.5 * p[1] + 3, 2 * p[1] - 0.3 * p[2], 2 * p[2] + 0.1 * p[0] - 1};
    };
    std::vector<Vec3> positions = mesh.positions;
    for (Vec3& p : positions) p = moved(p);
    surface.refit(positions);
    EXPECT_TRUE(std::ranges::equal(surface.mesh().positions, positions));
    EXPECT_TRUE(std::ranges::equal(surface.texel_faces(), owners));
    double worst = 0;
    const std::vector<Vec3> now = surface.sample_points();
    for (std::size_t i = 0; i < before.size(); ++i) {
      worst = std::max(worst, norm(now[i] - moved(before[i])));
      ASSERT_EQ(now[i], surface.texel_point(surface.sample_texels()[i]));
    }
    EXPECT_LE(worst, 1e-9 * size);
    bound.refit(surface);
    EXPECT_GT(bound.value(), 1.5 * first_bound);

    // Back again up to rounding; bit-identical where nothing moves.
    surface.refit(mesh.positions);
    const std::vector<Vec3> back = surface.sample_points();
    for (std::size_t i = 0; i < before.size(); ++i) ASSERT_LE(norm(back[i] - before[i]), 1e-9 * size);
    bound.refit(surface);
    EXPECT_NEAR(bound.value(), first_bound, 1e-6 * size);
    surface.refit(mesh.positions);
    EXPECT_EQ(surface.sample_points(), back);
  }
}

// Faces without area have charts, each of which owns a texel: its point was not a number after a refit.
TEST(SurfaceRefit, MovesTexelsOfFacesWithoutArea) {
  Mesh mesh = test::with_defects(test::load("blobby.off", "fit"));
  Surface surface(mesh, {.resolution = 512});
  const std::vector<Vec3> before = surface.sample_points();
  for (Vec3& p : mesh.positions) p = 1.5 * p + Vec3{1, 2, 3};
  surface.refit(mesh.positions);
  const std::vector<Vec3> after = surface.sample_points();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i)
    ASSERT_LE(norm(after[i] - (1.5 * before[i] + Vec3{1, 2, 3})), 1e-9) << i;
}

TEST(SurfaceRefit, RejectedPositionsChangeNothing) {
  Surface surface(test::load("cube.off"), {.resolution = 64});
  const std::vector<Vec3> before = surface.sample_points();
  std::vector<Vec3> positions = surface.mesh().positions;
  positions[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(surface.refit(positions), Error);
  positions.pop_back();
  EXPECT_THROW(surface.refit(positions), Error);
  EXPECT_EQ(surface.sample_points(), before);
}

// Regression: the search for a scale never tried the only ones that hold both the gutters and the charts.
TEST(Surface, ChartsOfOneTexelFillASmallAtlas) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 53; ++i) {
    mesh.positions.insert(mesh.positions.end(), {{2.0 * i, 0, 0}, {2.0 * i + 1, 0, 0}, {2.0 * i, 1, 0}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(Surface(mesh, {.kind = AtlasKind::triangles, .resolution = 24}).chart_count(), 53u);
  EXPECT_THROW(Surface(mesh, {.kind = AtlasKind::triangles, .resolution = 20}), Error);
}

}  // namespace
}  // namespace sdm
