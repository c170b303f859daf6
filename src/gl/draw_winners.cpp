#include "gl/draw_winners.h"
#include "gl/raster_report.h"

#include <sdm/error.h>

#include <string>
#include <utility>

#include "core/stopwatch.h"
#include "gl/polygons/oriented_box.h"

namespace sdm::gl {
namespace {

// The polygons of the engine: regions, clipped to domains.
struct RegionPolygons {
  using Batch = RasterBatch;

  RasterRules rules;
  double reach;

  [[nodiscard]] OrientedBox box(const SiteRegion& region) const {
    return oriented_box(region, reach, rules.slack);
  }
  bool add(RasterBatch& batch, const SiteRegion& region, const OrientedBox&,
           const PlanarDomain& domain) const {
    return add_polygon(batch, region, domain, rules);
  }
};

void expect_no_cracks(const Surface& surface, std::span<const std::uint32_t> winners,
                      const RasterReport& report) {
  const std::span<const std::uint32_t> owners = surface.texel_faces();
  for (std::size_t texel = 0; texel < owners.size(); ++texel)
    if (owners[texel] != kNone && winners[texel] == kNone)
      throw Error(report.device.name + " left texel " + std::to_string(texel) +
                  " without a value, which OpenGL does not allow; use another device or engine");
}

}  // namespace

RasterWinners draw_winners(const RasterDevice& device, const DrawTask& task, RasterReport& report) {
  MapDrawing map(task, report);
  const RasterRules rules{map.slack(), depth_scale(map.reach())};
  const surface::Tiles& tiles = task.tile_tree.tiles;
  const Ownership owned =
      task.gl.clip == GlClip::planes
          ? Ownership(OwnerTable{task.surface.texel_faces()})
          : Ownership(StencilValues{tiles.face_offsets, tiles.texels, task.gl.stencil_values});
  Stopwatch watch;
  Rasteriser rasteriser(device, {task.surface.resolution(), task.surface.rows()}, owned);
  report.time_ms.draw = watch.lap();
  map.draw(RegionPolygons{rules, map.reach()}, rasteriser);
  watch.lap();
  RasterImage image = rasteriser.read_back();
  rasteriser.count_into(report);
  report.time_ms.read_back = watch.lap();
  if (task.options.max_distance == kInfinity) expect_no_cracks(task.surface, image.winners, report);
  return {.winners = std::move(image.winners),
          .depths = std::move(image.depths),
          .depth_unit = 1 / rules.to_depth / task.sites.frame.scale,
          .tolerance = 1.5 * rules.slack / task.sites.frame.scale};
}

}  // namespace sdm::gl
