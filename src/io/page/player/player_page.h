// The file player.html.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "io/page/player/sequence_player.h"

namespace sdm::io {

struct PlayerFrame {
  std::size_t number = 0;                         ///< among the frames added
  std::array<std::vector<Vec3f>, 2> positions{};  ///< of the vertices drawn of each body
  std::array<std::vector<float>, 2> distances{};  ///< of each of them, or none for O2
};

struct PlayerContent {
  std::span<const PlayerFrame> frames;
  std::span<const std::size_t> added;  ///< the numbers, in the sequence, of all frames added
  std::size_t stride = 1;              ///< frames added for each one shown
  std::array<std::span<const Triangle>, 2> triangles{};
  std::span<const PlotPanel> panels;
};

/// `fixed`: of fixed_colors(). Throws sdm::Error if the file cannot be written, and if there is no page in
/// this build.
void write_player_page(const std::filesystem::path& file, const PlayerContent& content,
                       const PlayerOptions& options, const PictureOptions& fixed);

}  // namespace sdm::io
