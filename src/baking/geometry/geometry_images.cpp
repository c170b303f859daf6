#include <sdm/bake.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {
namespace {

constexpr std::size_t kNumbersOfTask = 1 << 15;

Image empty_image(std::uint32_t resolution, std::size_t numbers, std::uint32_t components,
                  std::uint32_t bits) {
  if (bits != 8 && bits != 16) throw Error("a picture of geometry has 8 or 16 bits a number");
  if (resolution == 0 || numbers == 0 || numbers % (std::size_t{components} * resolution) != 0)
    throw Error("a picture of geometry needs whole rows of texels");
  Image image{.width = resolution,
              .height = static_cast<std::uint32_t>(numbers / components / resolution),
              .components = components,
              .bits = bits,
              .bytes = {}};
  image.bytes.resize(numbers * (bits / 8));
  return image;
}

/// Sets all numbers, each from share(i), from 0 to 1.
template <class Share>
void set_numbers(Image& image, const Share& share) {
  const std::size_t bytes = image.bits / 8;
  const double largest = image.bits == 8 ? 255 : 65535;
  parallel_for(image.bytes.size() / bytes, kNumbersOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto number = static_cast<std::uint32_t>(std::lround(share(i) * largest));
      for (std::size_t k = 0; k < bytes; ++k)
        image.bytes[bytes * i + k] = static_cast<std::uint8_t>(number >> (8 * k));
    }
  });
}

}  // namespace

Image normal_map_image(std::uint32_t resolution, std::span<const float> normals, std::uint32_t bits) try {
  Image image = empty_image(resolution, normals.size(), 3, bits);
  set_numbers(image, [&](std::size_t i) {
    const double straight = i % 3 == 2 ? 1 : 0;
    const double x = std::isfinite(normals[i]) ? std::clamp(double{normals[i]}, -1.0, 1.0) : straight;
    return 0.5 * x + 0.5;
  });
  return image;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a picture of normals");
}

Image normal_map_image(const Surface& surface, std::span<const float> normals, std::uint32_t bits) {
  if (normals.size() != 3 * surface.texel_faces().size())
    throw Error("a normal map needs three numbers for each texel of the surface");
  return normal_map_image(surface.resolution(), normals, bits);
}

ScalarImage scalar_image(std::uint32_t resolution, std::span<const float> values,
                         const std::array<double, 2>& range, std::uint32_t bits) try {
  const auto [lower, upper] = range;
  if (!(upper > lower && std::isfinite(upper - lower)))
    throw Error("the range of a picture of lengths is empty");
  ScalarImage result{empty_image(resolution, values.size(), 1, bits), lower, upper};
  set_numbers(result.image, [&](std::size_t i) {
    return std::isfinite(values[i])
               ? std::clamp((values[i] - result.lower) / (result.upper - result.lower), 0.0, 1.0)
               : 0.0;
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a picture of lengths");
}

}  // namespace sdm
