// The gl engine: the paper's Algorithm 1 on OpenGL.
#pragma once

#include <sdm/map.h>

#include <vector>

namespace sdm {

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

/// Draws the map. Throws sdm::Error where OpenGL fails, or sdm was built without; Cancelled.
[[nodiscard]] RasterWinners gl_winners(const Surface& surface, const Sites& sites, const MapOptions& options,
                                       GlReport& report);

}  // namespace sdm
