#include <sdm/error.h>
#include <webp/decode.h>

#include "io/image/textures/decoders.h"

namespace sdm::io {

std::size_t pixels_of_webp(std::span<const char> bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), &features) !=
      VP8_STATUS_OK)
    return 0;
  return check_size(static_cast<std::size_t>(features.width), static_cast<std::size_t>(features.height));
}

Image decode_webp(std::span<const char> bytes) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK)
    throw Error("the WebP picture cannot be read: it is truncated or damaged");
  if (features.has_animation != 0) throw Error("the WebP picture is animated; only still ones are textures");
  const auto width = static_cast<std::size_t>(features.width),
             height = static_cast<std::size_t>(features.height);
  check_size(width, height);
  constexpr int kLossless = 2;  // which libwebp decodes as a whole
  const PromisedMemory decoded(width * height * (features.format == kLossless ? 4 : 1));
  Image image = blank_image(width, height, features.has_alpha != 0 ? 4 : 3, 8);
  const auto decode = features.has_alpha != 0 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  if (decode(data, bytes.size(), image.bytes.data(), image.bytes.size(),
             features.width * static_cast<int>(image.components)) == nullptr)
    throw Error("the WebP picture cannot be read: it is truncated or damaged");
  return image;
}

}  // namespace sdm::io
