#include <sdm/baked_geometry.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {

Image normal_map_image(const Surface& surface, std::span<const float> normals, std::uint32_t bits) try {
  if (bits != 8 && bits != 16) throw Error("a normal map has 8 or 16 bits a number");
  if (normals.size() != 3 * surface.texel_faces().size())
    throw Error("a normal map needs three numbers for each texel of the surface");
  const std::size_t bytes = bits / 8;
  const float largest = bits == 8 ? 255.f : 65535.f;
  Image image{
      .width = surface.resolution(), .height = surface.rows(), .components = 3, .bits = bits, .bytes = {}};
  image.bytes.resize(normals.size() * bytes);
  constexpr std::size_t kTexelsOfTask = 1 << 14;
  parallel_for(normals.size() / 3, kTexelsOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
      const float straight = i % 3 == 2 ? 1.f : 0.f;
      const float x = std::isfinite(normals[i]) ? std::clamp(normals[i], -1.f, 1.f) : straight;
      const auto number = static_cast<std::uint32_t>(std::lround((0.5f * x + 0.5f) * largest));
      for (std::size_t k = 0; k < bytes; ++k)
        image.bytes[bytes * i + k] = static_cast<std::uint8_t>(number >> (8 * k));
    }
  });
  return image;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a picture of normals");
}

}  // namespace sdm
