// The legend beside a map: colour bar, ticks, range, units.
#pragma once

#include <sdm/map.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/picture.h"

namespace sdm::io {

/// The multiples in [lo, hi] of a round step, 1, 2 or 5 times a power of ten, close to (hi − lo) / count.
[[nodiscard]] std::vector<double> ticks(double lo, double hi, int count);
/// The label of a tick: short, but distinct from those of its neighbours, `step` away.
[[nodiscard]] std::string tick_label(double value, double step);
/// A number with four significant digits.
[[nodiscard]] std::string value_label(double value);

/// A number beside the bar of a legend.
struct ScaleLabel {
  double value = 0;
  std::string text;       ///< empty for a limit next to another number
  bool is_limit = false;  ///< of the tolerance, and inside of the bar
};

/// The numbers beside the bar, from the lowest: both ends, the limits of a tolerance, and round ones that are
/// not close to these. Those of the pages are the same.
[[nodiscard]] std::vector<ScaleLabel> scale_labels(const ColorScale& scale);

struct LegendText {
  std::string title, units;
  std::vector<std::string> notes;    ///< one per line, below the bar
  bool has_missing = false;          ///< explains the colour of texels without a value
  std::string subtitle{};            ///< in place of the units
  std::vector<ScaleLabel> labels{};  ///< in place of those of the scale
};

/// Describes a map whose distances are from `least` to `most`; there are none if least > most.
[[nodiscard]] LegendText legend_text(const DistanceMap& map, double least, double most,
                                     const ColorScale& scale, const std::string& units);

/// Draws a legend for a map of `resolution` rows. The legend may be lower than that or, for small maps,
/// higher.
[[nodiscard]] Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution);

/// Draws colours of faces, edges and vertices of O2, as of site_color(), with their names, for a picture of
/// `rows` rows; `has_missing`: also the colour of texels without a value.
[[nodiscard]] Picture draw_site_legend(std::uint32_t rows, bool has_missing);

}  // namespace sdm::io
