// Consecutive samples are close together on the surface.
#include "surface/sample_order.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <vector>

#include "geometry/spatial_order.h"
#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

/// The mean diagonal of the boxes around runs of this length.
double mean_box(const std::vector<Vec3>& points, std::size_t run) {
  double sum = 0;
  std::size_t runs = 0;
  for (std::size_t first = 0; first < points.size(); first += run, ++runs) {
    Box box;
    for (std::size_t i = first; i < std::min(points.size(), first + run); ++i) extend(box, points[i]);
    sum += diagonal(box);
  }
  return sum / static_cast<double>(runs);
}

// A k-d tree over single samples is the best order known: boxes may be a quarter larger.
void expect_compact(const Surface& surface) {
  std::vector<std::uint32_t> owned;
  for (std::uint32_t texel = 0; texel < surface.map_faces().size(); ++texel)
    if (surface.map_faces()[texel] != kNone) owned.push_back(texel);
  std::vector<std::uint32_t> order = surface::sample_order(internals(surface));
  ASSERT_TRUE(std::ranges::equal(order, surface.sample_texels()));
  std::ranges::sort(order);
  EXPECT_EQ(order, owned);

  const std::vector<Vec3> points = surface.sample_points();
  std::vector<Vec3> best;
  for (const std::uint32_t i : spatial_order(points)) best.push_back(points[i]);
  for (const std::size_t run : {16u, 64u, 256u, 4096u})
    EXPECT_LE(mean_box(points, run), 1.25 * mean_box(best, run)) << run;
}

TEST(SampleOrder, KeepsNeighboursTogether) {
  const Mesh bunny = test::load("bunny.obj", "fit");
  for (const std::uint32_t resolution : {64u, 250u, 1024u}) {
    SCOPED_TRACE(resolution);
    expect_compact(Surface(bunny, {.resolution = resolution}));
  }
}

TEST(SampleOrder, OfSmallChartsAndOfFewSamples) {
  expect_compact(Surface(test::load("head.off", "fit"), {.kind = AtlasKind::triangles, .resolution = 512}));
  expect_compact(Surface(test::cube(), {.resolution = 16}));
  expect_compact(Surface(test::tetrahedron(), {.kind = AtlasKind::triangles, .resolution = 17}));
}

// The order in a packet is that of the texels, not that in which a selection leaves them.
TEST(SampleOrder, IsAscendingInEachPacket) {
  const Mesh bunny = test::load("bunny.obj", "fit");
  for (const std::uint32_t resolution : {250u, 1024u}) {
    const Surface surface(bunny, {.resolution = resolution});
    const auto order = surface.sample_texels();
    for (std::size_t first = 0; first < order.size(); first += 16)
      ASSERT_TRUE(
          std::ranges::is_sorted(order.subspan(first, std::min<std::size_t>(16, order.size() - first))));
  }
}

// Far from the origin, single precision must not be that of the coordinates.
TEST(SampleOrder, FarFromTheOrigin) {
  expect_compact(Surface(test::placed(test::cube(), "translate:1e7:1e7:1e7"), {.resolution = 128}));
}

}  // namespace
}  // namespace sdm
