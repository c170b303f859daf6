// The gl engine: surface distance maps by rasterisation with OpenGL.
#pragma once

#include <sdm/gl.h>

#include <limits>

#include "engine/engine.h"
#include "gl/polygons/corrections.h"

namespace sdm::gl {

inline constexpr EngineInfo kInfo{
    .name = "gl", .summary = "the paper's, using OpenGL", .relative_error = 2e-6, .maps_only = true};

/// Of an engine that draws without Corrections::confirmation: nothing bounds its error.
inline constexpr EngineInfo kUnconfirmedInfo{.name = kInfo.name,
                                             .summary = kInfo.summary,
                                             .relative_error = std::numeric_limits<double>::infinity(),
                                             .maps_only = true};

/// Returns a gl engine with some of the corrections only; GlOptions::paper_literal is ignored. Throws as the
/// public function does, and for fragment_vectors without affine_vectors. Without `tiles` or with
/// interpolated vectors, polygons must be clipped by the stencil.
[[nodiscard]] std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options,
                                                           const Corrections& corrections);

}  // namespace sdm::gl
