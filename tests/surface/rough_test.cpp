// Atlases of scans: noise at the scale of the faces.
#include <gtest/gtest.h>
#include <sdm/sampling_bound.h>
#include <sdm/surface.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "atlas/charts/cluster.h"
#include "atlas/charts/overlap.h"
#include "atlas/charts/rough.h"
#include "atlas/invariants.h"
#include "support/noise.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

// As documented for AtlasOptions::max_stretch.
constexpr double kMostStretch = 4;

Mesh scan_of_torus(double along_normals, double all_ways = 0) {
  return test::with_noise(test::torus(224, 112), along_normals, all_ways);
}

void expect_atlas(const Surface& surface) {
  test::expect_charts(surface);
  test::expect_owners(surface);
  test::expect_gutters(surface, surface.gutter());
  test::expect_maps(surface);
  test::expect_stretch(surface);
  test::expect_samples(surface);
  EXPECT_LE(surface.max_stretch(), kMostStretch);
}

/// No two faces of a chart overlap, exactly, on a grid that is far finer than the texels.
void expect_injective(const Surface& surface) {
  constexpr double kSlack = 1e-6;  // texels, of rounding
  std::vector<std::vector<atlas::GridTriangle>> charts(surface.chart_count());
  const double step = atlas::kGridSteps / static_cast<double>(std::max(surface.resolution(), surface.rows()));
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    atlas::GridTriangle& t = charts[surface.face_charts()[f]].emplace_back();
    const auto corners = surface.atlas_corners(f);
    for (std::size_t k = 0; k < 3; ++k)  // v runs down
      t[k] = {static_cast<std::int32_t>(std::lround(step * corners[k][0])),
              atlas::kGridSteps - static_cast<std::int32_t>(std::lround(step * corners[k][1]))};
  }
  std::size_t overlapping = 0;
  for (const auto& chart : charts) overlapping += atlas::find_overlap(chart, kSlack * step).has_value();
  EXPECT_EQ(overlapping, 0u);
}

/// No point is farther from the nearest sample of a whole search than the radius.
void expect_radius(const Surface& surface) {
  const double radius = covering_radius(surface);
  std::mt19937 random(5);
  const std::vector<Vec3> samples = surface.sample_points();
  double seen = 0;
  for (const Vec3& p : test::random_surface_points(surface.mesh(), 200, random)) {
    double nearest = radius * 1e3;
    for (const Vec3& s : samples) nearest = std::min(nearest, squared_norm(s - p));
    seen = std::max(seen, std::sqrt(nearest));
  }
  EXPECT_LE(seen, radius);
  // Corners of the most stretched texel are half its diagonal away, pieces beside it at most as much again.
  double diagonal = 0;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    const auto [u, v] = surface.texel_edges(f);
    diagonal = std::max({diagonal, norm(u + v), norm(u - v)});
  }
  EXPECT_LE(radius, diagonal);
}

TEST(RoughSurfaces, HaveFewChartsAndUseTheAtlas) {
  for (const double noise : {0.3, 0.5}) {
    SCOPED_TRACE(noise);
    const Surface surface(scan_of_torus(noise), {.resolution = 512});
    expect_atlas(surface);
    expect_injective(surface);
    expect_radius(surface);
    EXPECT_GE(surface.utilisation(), 0.55);
    EXPECT_LE(surface.chart_count() * 50, surface.mesh().triangles.size());
    EXPECT_GT(surface.max_stretch(), AtlasOptions{}.max_stretch);
  }
}

TEST(RoughSurfaces, FoldsAreLaidOutWithoutOverlap) {
  for (const auto& [along, all_ways] : {std::pair(0.3, 0.3), std::pair(1.0, 0.0), std::pair(1.0, 0.7)}) {
    SCOPED_TRACE(all_ways);
    const Surface surface(scan_of_torus(along, all_ways), {.resolution = 512});
    expect_atlas(surface);
    expect_injective(surface);
    expect_radius(surface);
  }
}

TEST(RoughSurfaces, HolesBetweenChartsAreThoseOfTheMesh) {
  // A sheet with a hole and a rim: charts end there, and no face is lost.
  Mesh sheet = test::with_noise(test::height_field(180), 0.4, 0.1);
  std::erase_if(sheet.triangles, [](const Triangle& t) { return t[0] % 7 == 0 && t[0] / 180 % 9 == 0; });
  sheet.corner_uvs.clear();
  const Surface surface(std::move(sheet), {.resolution = 512, .gutter = 2});
  expect_atlas(surface);
  expect_injective(surface);
}

TEST(RoughSurfaces, TheLayoutIsTheSameForAnyMeshScale) {
  const Mesh mesh = scan_of_torus(0.3);
  Mesh large = mesh;
  for (Vec3& p : large.positions) p = 1024.0 * p;
  const Surface a(mesh, {.resolution = 512}), b(std::move(large), {.resolution = 512});
  EXPECT_TRUE(std::ranges::equal(a.texel_faces(), b.texel_faces()));
}

TEST(RoughSurfaces, SmoothOnesKeepTheStretch) {
  const Surface surface(test::torus(448, 224), {.resolution = 512});
  EXPECT_LE(surface.max_stretch(), AtlasOptions{}.max_stretch);
}

TEST(RoughSurfaces, TheStretchIsKeptWhereTexelsAreMany) {
  const Surface surface(scan_of_torus(0.3), {.resolution = 1024});
  expect_atlas(surface);
  EXPECT_LE(surface.max_stretch(), AtlasOptions{}.max_stretch);
  EXPECT_GE(surface.utilisation(), 0.4);
}

TEST(RoughSurfaces, ALittleStretchIsKeptWhateverTheNumberOfClusters) {
  const Mesh mesh = test::joined(test::sphere(7), test::moved(test::cube(), {3, 0, 0}));
  for (const double most : {1.0008, 1.001}) {
    const Surface surface(mesh, {.resolution = 512, .max_stretch = most});
    EXPECT_LE(surface.max_stretch(), most);
    EXPECT_GE(surface.chart_count(), 4096u);
  }
}

TEST(RoughSurfaces, AssembliesOfSmoothPartsAreLaidOutAsOthers) {
  constexpr std::size_t kRings = 160, kEnoughClusters = 4096;
  const Mesh ring = test::ring(48);
  Mesh mesh;
  for (std::uint32_t i = 0; i < kRings; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : ring.positions) mesh.positions.push_back(p + Vec3{0, 0, 1.0 * i});
    for (const Triangle& t : ring.triangles)
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const atlas::FaceGeometry faces = atlas::face_geometry(mesh);
  const double cos_angle = 1 / AtlasOptions{}.max_stretch;
  const auto expected = atlas::cluster_faces(mesh, faces, cos_angle);
  ASSERT_GE(expected.first, kEnoughClusters);
  const auto [charts, rough] = atlas::cluster_rough_faces(mesh, faces, cos_angle, 512);
  EXPECT_FALSE(rough);
  ASSERT_EQ(charts.size(), expected.charts->size());
  for (std::size_t c = 0; c < charts.size(); ++c) {
    EXPECT_EQ(charts[c].axis, (*expected.charts)[c].axis);
    EXPECT_EQ(charts[c].faces, (*expected.charts)[c].faces);
  }
}

Mesh scan_beside_fan(int slivers) {
  return test::joined(test::with_noise(test::height_field(180), 0.35),
                      test::moved(test::fan(slivers), {0, 0, 5}));
}

TEST(RoughSurfaces, FansOfSliversAreCut) {
  constexpr int kSlivers = 5000;
  const Surface surface(scan_beside_fan(kSlivers), {.resolution = 512});
  expect_atlas(surface);
  expect_injective(surface);
  EXPECT_GT(surface.max_stretch(), AtlasOptions{}.max_stretch);
  const auto charts = surface.face_charts().last(kSlivers);
  EXPECT_NE(std::ranges::min(charts), std::ranges::max(charts));
}

TEST(RoughSurfaces, FansOfManySliversAreNotTestedInFull) {
  constexpr std::size_t kSlivers = 80'000;
  const Mesh mesh = scan_beside_fan(kSlivers);
  const auto [charts, rough] =
      atlas::cluster_rough_faces(mesh, atlas::face_geometry(mesh), 1 / AtlasOptions{}.max_stretch, 512);
  EXPECT_TRUE(rough);
  EXPECT_TRUE(std::ranges::any_of(charts, [](const auto& chart) { return chart.faces.size() == kSlivers; }));
}

}  // namespace
}  // namespace sdm
