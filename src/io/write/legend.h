// The legend beside a map: colour bar, ticks, range, units.
#pragma once

#include "io/write/color_scale.h"

#include <cstdint>
#include <string>
#include <vector>

namespace sdm {

struct LegendText {
  std::string title, units;
  std::vector<std::string> notes;  ///< a line each, below the bar
  bool has_missing = false;        ///< explain the colour of texels without a value
};

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// Draws a legend for a map of `resolution` rows; it may be lower or, for small maps, higher than that.
[[nodiscard]] Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution);

/// Round numbers (1, 2 or 5 times a power of ten) apart by about a `count`-th of [lo, hi], all within.
[[nodiscard]] std::vector<double> ticks(double lo, double hi, int count);

}  // namespace sdm
