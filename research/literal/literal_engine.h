// The paper's Algorithm 1 as it is printed, or with some of the corrections of the gl engine.
#pragma once

#include <sdm/gl.h>

#include <memory>
#include <optional>

#include "gl/raster_report.h"
#include "research/literal/corrections.h"

namespace sdm::literal {

/// Returns an engine that computes maps; GlOptions::clip is ignored: it clips by the stencil. Without
/// confirmation its relative_error is infinite: distances and vectors are estimates of unknown accuracy, and
/// texels may have no value. Throws sdm::Error for fragment_vectors without affine_vectors.
[[nodiscard]] std::shared_ptr<const Engine> make_engine(const GlOptions& options,
                                                        const Corrections& corrections);

/// The report of the last map of such an engine, without fragments; without tiles, those are the faces.
[[nodiscard]] std::optional<gl::RasterReport> report(const Engine& engine);

}  // namespace sdm::literal
