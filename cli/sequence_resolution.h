// The resolution that keeps the error bound of a map small in all frames.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <functional>

#include "sequence_body.h"

/// Returns a resolution at which the error bound of the body's map is at most `precision` in every frame that
/// can be read; atlas.resolution is ignored. `open` opens the body at its first frame; `progress` is called
/// with the number of each frame. Throws sdm::Error if 32768 texels per side do not suffice, and as
/// sdm::resolution_for does. Cost: some layouts of the first frame, and reading all frames once, or a few
/// times if the first resolution does not suffice.
[[nodiscard]] std::uint32_t resolution_for_frames(const std::function<Body()>& open,
                                                  const sdm::AtlasOptions& atlas, double precision,
                                                  const std::function<void(std::size_t)>& progress);
