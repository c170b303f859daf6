// The gl engine: surface distance maps by rasterisation with OpenGL.
#pragma once

#include <sdm/engine.h>

namespace sdm::gl {

inline constexpr EngineInfo kInfo{
    .name = "gl", .summary = "the paper's, using OpenGL", .relative_error = 2e-6, .takes_points = false};

}  // namespace sdm::gl
