// 16-bit grey images as PNG, written row by row.
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <span>

namespace sdm::io {

/// Writes `height` rows; `row(y, pixels)` fills each. The values are numbers, not brightnesses: the file has
/// no colour space. Does not check the stream, whose state records failures.
void write_gray_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
                    const std::function<void(std::uint32_t y, std::span<std::uint16_t> pixels)>& row);

}  // namespace sdm::io
