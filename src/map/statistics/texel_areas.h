// The area that a texel stands for.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <vector>

#include "geometry/vec.h"

namespace sdm::map {

/// The surface area of a texel of each face, |∂p/∂u × ∂p/∂v|, which is the same for all texels of a face; 0
/// for faces without a chart. Cost: linear in faces.
[[nodiscard]] inline std::vector<double> texel_areas(const Surface& surface) {
  const auto charts = surface.face_charts();
  std::vector<double> areas(charts.size());
  for (std::uint32_t face = 0; face < charts.size(); ++face) {
    if (charts[face] == kNone) continue;
    const auto [du, dv] = surface.texel_edges(face);
    areas[face] = norm(cross(du, dv));
  }
  return areas;
}

}  // namespace sdm::map
