// A picture in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "io/image/pictures/color_scale.h"

namespace sdm::io {

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgb> pixels;
};

}  // namespace sdm::io
