// sRGB as IEC 61966-2-1 has it, independent of the code under test.
#pragma once

#include <cmath>

namespace sdm::test {

inline double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
inline double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace sdm::test
