/// Pictures in memory: textures of meshes.
///
/// Threads: an Image is a plain value; the functions may be called concurrently.
#pragma once

#include <sdm/api.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace sdm {

/// Pixels, row after row from the top, of grey, grey and alpha, red, green and blue, or these and alpha.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::uint32_t components = 0;  ///< 1 to 4
  std::uint32_t bits = 8;        ///< of a number, 8 or 16
  /// Each number in one byte, or in two with the lower one first.
  std::vector<std::uint8_t> bytes;

  /// A number, from 0 to 1 as the file has it: colours usually in sRGB.
  [[nodiscard]] float value(std::uint32_t x, std::uint32_t y, std::uint32_t component) const {
    const std::size_t i = (std::size_t{y} * width + x) * components + component;
    if (bits == 8) return static_cast<float>(bytes[i]) / 255.f;
    return static_cast<float>(bytes[2 * i] | bytes[2 * i + 1] << 8) / 65535.f;
  }
};

/// The intensity in linear light of a colour component in sRGB (IEC 61966-2-1), both from 0 to 1.
[[nodiscard]] inline float linear_light(float srgb) {
  if (srgb <= 0.04045f) return srgb / 12.92f;
  return std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

/// Decodes a PNG, JPEG or WebP file, by its content. Palettes become colours, fewer bits than 8 become 8, and
/// CMYK becomes red, green and blue, as without a colour profile. Colour profiles and gamma are ignored, as
/// glTF has it. Throws sdm::Error for other formats, for damaged and truncated files, for more than 100,000
/// pixels a side or 2^28 in total, and if there is not enough memory. Cost: linear in pixels.
[[nodiscard]] SDM_API Image decode_image(std::span<const char> bytes);

/// decode_image() of a file, whose name the errors begin with.
[[nodiscard]] SDM_API Image read_image(const std::filesystem::path& file);

/// Returns a PNG file with these pixels; `srgb`: colours (of three or four components) are stated to be in
/// sRGB. Made for speed rather than size. Throws sdm::Error if the picture has no pixels or its bytes are not
/// those of its pixels, and if there is not enough memory. Cost: linear, all cores.
[[nodiscard]] SDM_API std::vector<char> encode_png(const Image& image, bool srgb = true);

}  // namespace sdm
