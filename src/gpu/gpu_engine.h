// The gpu engine: a search of the tree by compute shaders in WGSL, finished in double precision on the
// processor. Its options and report are public (sdm/gpu.h).
#pragma once

#include <sdm/engine.h>

namespace sdm::gpu {

inline constexpr EngineInfo kInfo{
    .name = "gpu", .summary = "a search by compute shaders", .relative_error = 1e-6};

}  // namespace sdm::gpu
