// Images as PNG, in strips of rows that all threads compress.
#pragma once

#include "io/image/pictures/color_scale.h"

#include <sdm/mesh_attributes.h>

#include <cstdint>
#include <functional>
#include <ostream>
#include <span>

namespace sdm::io {

/// Writes `height` rows of 8-bit RGB; `row(y, pixels)` fills each, called from several threads at once and in
/// any order. Optimised for speed rather than size. Does not check the stream, whose state records failures.
void write_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
               const std::function<void(std::uint32_t y, std::span<Rgb> pixels)>& row);

/// The same for a picture with 1 to 4 components of 8 or 16 bits; `srgb`: colours are stated to be in sRGB.
void write_image_png(std::ostream& stream, const Image& image, bool srgb);

/// The same for 16-bit grey values, which are numbers, not brightnesses: the file has no colour space.
void write_gray_png(std::ostream& stream, std::uint32_t width, std::uint32_t height,
                    const std::function<void(std::uint32_t y, std::span<std::uint16_t> values)>& row);

}  // namespace sdm::io
