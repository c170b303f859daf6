#include <sdm/bake.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {
namespace {

/// The number of 8 bits whose colour in sRGB is nearest to a value in linear light.
class SrgbBytes {
 public:
  SrgbBytes() {
    for (std::size_t i = 0; i < 255; ++i) ends_[i] = linear_light((static_cast<float>(i) + 0.5f) / 255);
    std::uint8_t byte = 0;
    for (std::size_t i = 0; i < kGuesses; ++i) {
      while (byte < 255 && static_cast<float>(i) / kGuesses >= ends_[byte]) ++byte;
      guesses_[i] = byte;
    }
  }
  [[nodiscard]] std::uint8_t operator()(float value) const {
    if (!(value > 0)) return 0;  // also NaN
    if (value >= ends_[254]) return 255;
    std::uint8_t byte = guesses_[static_cast<std::size_t>(value * kGuesses)];
    while (value >= ends_[byte]) ++byte;
    return byte;
  }

 private:
  static constexpr std::size_t kGuesses = 4096;

  std::array<float, 255> ends_{};  ///< of each number but the last one, where the next one begins
  std::array<std::uint8_t, kGuesses> guesses_{};
};

std::uint8_t plain_byte(float value) {
  if (!(value > 0)) return 0;  // also NaN
  return static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.f)));
}

}  // namespace

Image to_image(const BakedChannel& baked) try {
  if (baked.components == 0 || baked.resolution == 0 || baked.values.empty() ||
      baked.values.size() % (baked.components * baked.resolution) != 0)
    throw Error("a picture of a baked texture needs whole rows of texels");
  const bool mixed = baked.channel == BakeChannel::metallic_roughness;
  if (mixed && baked.components != 2)
    throw Error("a picture of metallic_roughness needs 2 numbers for each texel, not " +
                std::to_string(baked.components));
  static const SrgbBytes srgb;
  const std::size_t components = baked.components, texels = baked.values.size() / components;
  Image image{.width = baked.resolution,
              .height = static_cast<std::uint32_t>(texels / baked.resolution),
              .components = mixed ? 3 : static_cast<std::uint32_t>(components),
              .bits = 8,
              .bytes = {}};
  image.bytes.resize(texels * image.components);
  constexpr std::size_t kTexelsOfRange = 1 << 14;
  parallel_for(texels, kTexelsOfRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float* const values = &baked.values[i * components];
      std::uint8_t* const bytes = &image.bytes[i * image.components];
      if (mixed) {
        bytes[0] = 255;
        bytes[1] = plain_byte(values[0]);
        bytes[2] = plain_byte(values[1]);
      } else if (components == 1)
        bytes[0] = plain_byte(values[0]);
      else
        for (std::size_t k = 0; k < components; ++k)
          bytes[k] = k < 3 ? srgb(values[k]) : plain_byte(values[k]);
    }
  });
  return image;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a picture of a baked texture");
}

}  // namespace sdm
