// 8-bit RGB images as PNG, in strips of rows that all threads compress.
#pragma once

#include "io/write/pictures/color_scale.h"

#include <cstdint>
#include <functional>
#include <ostream>
#include <span>

namespace sdm::io {

/// Writes `height` rows; `row(y, pixels)` fills each, called from several threads at once and in any order.
/// Optimised for speed rather than size. Does not check the stream, whose state records failures.
void write_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
               const std::function<void(std::uint32_t y, std::span<Rgb> pixels)>& row);

}  // namespace sdm::io
