#include "io/image/pictures/site_legend.h"

#include <sdm/map.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "io/image/pictures/canvas.h"
#include "io/image/pictures/color_scale.h"

namespace sdm::io {
namespace {

// Lengths for 1024 rows; the drawing is scaled as a whole.
constexpr double kLegendWidth = 232, kLegendHeight = 300, kEdge = 24, kSwatch = 22, kRow = 60;
constexpr std::size_t kSwatches = 6;
constexpr int kLeastDifference = 90;  // of the sum of differences of red, green and blue

/// Colours of sites of a type, the first one and others that differ from each other.
std::vector<Rgb> examples(SiteType type) {
  std::vector<Rgb> colors;
  for (std::uint32_t site = 0; colors.size() < kSwatches && site < 1000; ++site) {
    const Rgb c = site_color(type, site);
    if (std::ranges::all_of(colors, [&](const Rgb& other) {
          return std::abs(c.r - other.r) + std::abs(c.g - other.g) + std::abs(c.b - other.b) >=
                 kLeastDifference;
        }))
      colors.push_back(c);
  }
  return colors;
}

}  // namespace

Picture draw_site_legend(std::uint32_t rows, bool has_missing) {
  Canvas canvas(kLegendWidth, kLegendHeight, std::clamp(rows / 1024.0, 0.6, 4.0));
  cairo_t* cairo = canvas.cairo();
  double y = 40;
  const auto text = [&](const std::string& line, double size, bool bold) {
    canvas.set_color(kInk);
    canvas.text(kEdge, y, line, size, kLegendWidth - 1.5 * kEdge, bold);
  };
  text("Closest site", 19, true);
  const auto swatch = [&](double x, Rgb color) {
    canvas.set_color(color);
    cairo_rectangle(cairo, x, y + 8, kSwatch, kSwatch);
    cairo_fill(cairo);
  };
  for (const auto& [type, name] :
       {std::pair(SiteType::face, "faces: pale"), std::pair(SiteType::edge, "edges: saturated"),
        std::pair(SiteType::vertex, "vertices: dark")}) {
    y += type == SiteType::face ? 34 : kRow;
    text(name, 15, false);
    double x = kEdge;
    for (const Rgb color : examples(type)) {
      swatch(x, color);
      x += kSwatch + 4;
    }
  }
  if (has_missing) {
    y += kRow;
    text("nothing in range", 15, false);
    swatch(kEdge, kNoValue);
  }
  return canvas.picture("the legend");
}

}  // namespace sdm::io
