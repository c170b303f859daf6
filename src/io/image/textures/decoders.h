// One decoder for each format of pictures. All throw sdm::Error; the message does not name the file.
#pragma once

#include <sdm/image.h>

#include <span>

namespace sdm::io {

[[nodiscard]] Image decode_png(std::span<const char> bytes);
[[nodiscard]] Image decode_jpeg(std::span<const char> bytes);
[[nodiscard]] Image decode_webp(std::span<const char> bytes);

/// Throws sdm::Error for a picture without pixels, or with more than 2^28.
void check_size(std::size_t width, std::size_t height);

/// A picture of this size, of which the bytes are to be set. Throws sdm::Error as check_size() does, and if
/// there is not enough memory.
[[nodiscard]] Image blank_image(std::size_t width, std::size_t height, std::uint32_t components,
                                std::uint32_t bits);

}  // namespace sdm::io
