// The legend beside a map: colour bar, ticks, range, units.
#pragma once

#include "io/write/pictures/color_scale.h"
#include "io/write/pictures/picture.h"

#include <cstdint>
#include <string>
#include <vector>

namespace sdm::io {

struct LegendText {
  std::string title, units;
  std::vector<std::string> notes;  ///< a line each, below the bar
  bool has_missing = false;        ///< explain the colour of texels without a value
};

/// Draws a legend for a map of `resolution` rows; it may be lower or, for small maps, higher than that.
[[nodiscard]] Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution);

}  // namespace sdm::io
