// One colour scale for all frames of `sdm sequence`.
#pragma once

#include <sdm/map_files.h>

#include <array>
#include <cstddef>
#include <functional>

#include "sequence_body.h"

/// Returns `picture` with a range that suits all frames: that of the frame, among some thirty that are
/// measured at vertices, whose distances reach farthest. Of the inputs alone, so that a run that is resumed
/// has the same. `open`: the bodies at their first frames. Frames that cannot be used are left out.
/// `changes`: their faces may change, so that all frames have to be read, in order. `progress` is called with
/// each frame.
[[nodiscard]] sdm::PictureOptions colors_for_frames(const std::function<std::array<Body, 2>()>& open,
                                                    const sdm::PictureOptions& picture, bool both,
                                                    bool changes,
                                                    const std::function<void(std::size_t)>& progress);
