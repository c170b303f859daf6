// The paper's Algorithm 1: the polygons of all sites, drawn into the atlas of O1 with a depth test.
#pragma once

#include <sdm/gl.h>

#include <vector>

#include "engine/engine.h"
#include "engine/gl/rasteriser.h"
#include "engine/gl/tile_tree.h"
#include "sites/sites_data.h"

namespace sdm::gl {

/// What was found at each texel of a surface in single precision.
struct RasterWinners {
  /// A face of O2 that the closest site belongs to; kNone where no face of O1 owns the texel, or nothing lies
  /// within the maximum distance.
  std::vector<std::uint32_t> faces;
  /// The distance drawn there, in units of `depth_unit`. All sites that are closest to some texel were drawn
  /// at it, so none is nearer than this: a face whose distance is no larger, but for the tolerance, is
  /// confirmed.
  std::vector<float> depths;
  double depth_unit = 1;
  double tolerance = 0;  ///< of what single precision, and regions drawn a little too large, do to depths

  [[nodiscard]] bool confirms(std::uint32_t texel, double distance) const {
    return distance <= depth_unit * static_cast<double>(depths[texel]) + tolerance;
  }
};

/// What to draw.
struct DrawTask {
  const Surface& surface;
  const TileTree& tile_tree;  ///< of the surface
  const sites::SitesData& sites;
  const GlOptions& gl;
  const engine::EngineOptions& options;
};

/// Draws the map on a device whose context is current, and fills the counts and times of the report up to
/// read_back. Throws sdm::Error where OpenGL fails; Cancelled.
[[nodiscard]] RasterWinners draw_winners(const RasterDevice& device, const DrawTask& task, GlReport& report);

}  // namespace sdm::gl
