// The paper's Algorithm 1: the polygons of all sites, drawn into the atlas of O1 with a depth test.
#pragma once

#include <vector>

#include "gl/map_drawing.h"
#include "gl/raster_report.h"
#include "gl/rasteriser.h"

namespace sdm::gl {

/// The result of drawing at each texel of a surface, in single precision.
struct RasterWinners {
  /// A face of O2 to which the closest site belongs; kNone where no face of O1 owns the texel, or nothing
  /// lies within the maximum distance.
  std::vector<std::uint32_t> winners;
  /// The distance drawn, in units of `depth_unit`. All sites that are closest to some texel were drawn there,
  /// so no site is nearer than this: a face whose distance is at most this, up to the tolerance, is
  /// confirmed.
  std::vector<float> depths;
  bool complete = true;  ///< nothing was drawn only where nothing lies within the maximum distance
  double depth_unit = 1;
  double tolerance = 0;  ///< error of depths from single precision and from enlarging the regions

  [[nodiscard]] bool confirms(std::uint32_t texel, double distance) const {
    return distance <= depth_unit * static_cast<double>(depths[texel]) + tolerance;
  }
};

/// Draws the map on a device whose context is current, and fills the report's counts and times up to
/// read_back. Throws sdm::Error if OpenGL fails; Cancelled.
[[nodiscard]] RasterWinners draw_winners(const RasterDevice& device, const DrawTask& task,
                                         RasterReport& report);

}  // namespace sdm::gl
