// A picture in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/image/pictures/color_scale.h"

namespace sdm::io {

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// Writes it as a PNG. Throws sdm::Error.
void write_picture(const std::filesystem::path& file, const Picture& picture);

}  // namespace sdm::io
