// Units of length that files are taken for by mistake.
#pragma once

#include <array>

namespace sdm {

struct LargerUnit {
  double millimetres;
  const char* name;
};

/// Files of parts are in millimetres, or in one of these.
inline constexpr std::array<LargerUnit, 4> kLargerUnits{
    {{10, "centimetres"}, {25.4, "inches"}, {304.8, "feet"}, {1000, "metres"}}};

}  // namespace sdm
