// Colours in sRGB and in linear light (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace sdm::baking {

/// The intensity in linear light of a colour component in sRGB, both from 0 to 1.
[[nodiscard]] inline float linear_light(float srgb) {
  if (srgb <= 0.04045f) return srgb / 12.92f;
  return std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

}  // namespace sdm::baking
