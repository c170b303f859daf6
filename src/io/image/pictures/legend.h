// The legend beside a map: colour bar, ticks, range, units.
#pragma once

#include <sdm/map.h>

#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/picture.h"

#include <cstdint>
#include <string>
#include <vector>

namespace sdm::io {

struct LegendText {
  std::string title, units;
  std::vector<std::string> notes;  ///< one per line, below the bar
  bool has_missing = false;        ///< explains the colour of texels without a value
};

/// Describes a map whose distances are from `least` to `most`; there are none if least > most.
[[nodiscard]] LegendText legend_text(const DistanceMap& map, double least, double most,
                                     const ColorScale& scale, const std::string& units);

/// Draws a legend for a map of `resolution` rows. The legend may be lower than that or, for small maps,
/// higher.
[[nodiscard]] Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution);

}  // namespace sdm::io
