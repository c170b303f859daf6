// The file animation.glb.
#pragma once

#include "io/page/player/player_page.h"

namespace sdm::io {

/// Writes the frames as one glTF model with a morph target for each frame after the first. `fixed`: of
/// fixed_colors(). Returns the number of frames written. Throws sdm::Error if the file cannot be written, and
/// if the bodies are too large for glTF.
std::size_t write_animated_model(const std::filesystem::path& file, const PlayerContent& content,
                                 const PlayerOptions& options, const PictureOptions& fixed);

}  // namespace sdm::io
