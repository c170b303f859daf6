// The texel table: which face owns each texel, and the order of the owned ones.
#pragma once

#include <cstdint>
#include <vector>

#include "atlas/layout.h"

namespace sdm {

/// The face whose triangle in the atlas has each texel's centre, or kNone. Every chart owns a texel, but for
/// AtlasKind::uv.
[[nodiscard]] std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind,
                                                   std::uint32_t resolution);

/// Owned texels, charts in spatial order, Z order within a chart.
[[nodiscard]] std::vector<std::uint32_t> order_samples(const Mesh& mesh, const Layout& layout,
                                                       const std::vector<std::uint32_t>& texel_faces,
                                                       const std::vector<std::uint32_t>& face_charts,
                                                       std::uint32_t resolution);

}  // namespace sdm
