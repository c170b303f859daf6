// The rasteriser on a slice of a grid: any plane with an affine map is a domain, not only a face of O1.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <vector>

#include "closest/reference/reference_engine.h"
#include "gl/raster_report.h"
#include "gl/rasteriser.h"
#include "sites/closest_on_face.h"
#include "support/map_checks.h"
#include "support/meshes.h"

namespace sdm::gl {
namespace {

constexpr std::uint32_t kSide = 64;

/// The slice at height z of the grid over [-1.5, 1.5]², in the unit frame of O2.
PlanarDomain slice(double z) {
  PlanarDomain domain;
  domain.origin = {-1.5, -1.5, z};
  domain.edges = {Vec3{3.0 / kSide, 0, 0}, Vec3{0, 3.0 / kSide, 0}};
  domain.outline = ConvexPolygon::rectangle({0, 0}, {kSide, kSide});
  return domain;
}

TEST(GridSlice, ContainsTheClosestFaces) {
  const Sites sites(test::load("cow.off", "fit"));
  const sites::SitesData& impl = internals(sites);
  const RasterDevice device("");
  const Context::Current current(device.context());
  for (const double z : {-0.9, 0.0, 0.37, 1.4}) {
    const PlanarDomain domain = slice(z);
    RasterBatch batch;
    for (std::size_t leaf = 0; leaf + 1 < impl.regions.leaves.size(); ++leaf)
      for_each_site(impl.regions, leaf, [&](const auto& site, std::size_t index) {
        if (!has_interior(site)) return;
        const SiteRegion region = region_of(impl, site, index);
        add_polygon(batch, region, domain, {1e-5, 0.125});
      });
    ASSERT_GT(batch.size(), 100u);
    Rasteriser rasteriser(device, {kSide, kSide}, WholeImage{});
    rasteriser.draw(batch);
    const std::vector<std::uint32_t> faces = rasteriser.read_back().winners;
    gl::RasterReport report;
    rasteriser.count_into(report);
    EXPECT_GE(report.fragments, faces.size());
    EXPECT_EQ(report.stencil_lookups, 0u);

    test::Disagreements wrong(1e-6 / impl.frame.scale);
    for (std::uint32_t texel = 0; texel < faces.size(); ++texel) {
      ASSERT_NE(faces[texel], kNone);
      const std::uint32_t column = texel % kSide, row = texel / kSide;
      const Vec3 unit = domain.point({column + 0.5, row + 0.5});
      const Vec3 q = (1 / impl.frame.scale) * unit + impl.frame.origin;
      const ClosestPoint expected = reference::reference_closest(impl, q, 1e30);
      wrong.compare(texel, sites::closest_on_face(impl, faces[texel], q).distance, expected.distance);
    }
    EXPECT_TRUE(wrong.none());
  }
}

}  // namespace
}  // namespace sdm::gl
