#include "io/mesh/polygons/polygon_attributes.h"

#include <cmath>

namespace sdm::io {

float linear_light(float srgb) {
  if (srgb <= 0.04045f) return srgb / 12.92f;
  return std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

}  // namespace sdm::io
