// The texel table: which face owns each texel.
#pragma once

#include <cstdint>
#include <vector>

#include "atlas/layout.h"

namespace sdm::atlas {

/// For each texel, the face whose triangle in the atlas contains its centre, or kNone. Every chart owns at
/// least one texel, except for AtlasKind::uv.
[[nodiscard]] std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind,
                                                   std::uint32_t resolution);

}  // namespace sdm::atlas
