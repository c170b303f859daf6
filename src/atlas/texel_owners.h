// The texel table: which face owns each texel.
#pragma once

#include <cstdint>
#include <vector>

#include "atlas/layout.h"

namespace sdm::atlas {

/// The face whose triangle in the atlas has each texel's centre, or kNone. Every chart owns a texel, but for
/// AtlasKind::uv.
[[nodiscard]] std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind,
                                                   std::uint32_t resolution);

/// The texels that a face owns, in their order.
[[nodiscard]] std::vector<std::uint32_t> owned_texels(const std::vector<std::uint32_t>& texel_faces);

}  // namespace sdm::atlas
