#include "io/write/legend.h"

#include <cairo.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace sdm {
namespace {

// Lengths at 1024 texels; everything is drawn in these and scaled.
constexpr double kWidth = 232, kMargin = 24, kBarWidth = 30, kBarTop = 84, kMaxHeight = 1024;
constexpr double kMinHeight = 460;
constexpr double kTitleSize = 19, kTextSize = 15, kLine = 23;

using Surface2D = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void set_color(cairo_t* cairo, Rgb color) {
  cairo_set_source_rgb(cairo, color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

void write_text(cairo_t* cairo, double x, double baseline, const std::string& text, double size,
                bool bold = false) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  // Long units shrink rather than leave the picture.
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  const double room = kWidth - x - kMargin / 2;
  if (extents.x_advance > room) cairo_set_font_size(cairo, size * room / extents.x_advance);
  cairo_move_to(cairo, x, baseline);
  cairo_show_text(cairo, text.c_str());
}

// Short, but told apart from its neighbours, which are `step` away.
std::string label(double value, double step) {
  char text[64];
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) {
    const int digits =
        std::clamp(static_cast<int>(std::floor(std::log10(size)) - std::floor(std::log10(step))), 0, 15);
    std::snprintf(text, sizeof text, "%.*e", digits, value);
  } else {
    std::snprintf(text, sizeof text, "%.*f",
                  std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15), value);
  }
  std::string result = text;
  if (const auto minus = result.find('-'); minus == 0) result.replace(0, 1, "\u2212");
  return result;
}

void draw_bar(cairo_t* cairo, const ColorScale& scale, double top, double bottom) {
  const auto height_of = [&](double d) {
    return bottom - (d - scale.lo) / (scale.hi - scale.lo) * (bottom - top);
  };
  constexpr int kSteps = 4096;  // finer than any pixel of the bar
  // Without smoothing every pixel has the colour of one step, not one that is mixed with the paper. Each step
  // reaches above itself, where the next one covers it, so that rounding leaves no seams.
  cairo_set_antialias(cairo, CAIRO_ANTIALIAS_NONE);
  for (int i = 0; i < kSteps; ++i) {
    const double foot = bottom - i * (bottom - top) / kSteps, head = std::max(top, foot - 3);
    set_color(cairo, scale(scale.lo + (i + 0.5) / kSteps * (scale.hi - scale.lo)));
    cairo_rectangle(cairo, kMargin, head, kBarWidth, foot - head);
    cairo_fill(cairo);
  }
  cairo_set_antialias(cairo, CAIRO_ANTIALIAS_DEFAULT);
  set_color(cairo, {60, 62, 66});
  cairo_set_line_width(cairo, 1);
  cairo_rectangle(cairo, kMargin, top, kBarWidth, bottom - top);
  cairo_stroke(cairo);

  const auto values = ticks(scale.lo, scale.hi, 10);
  const double step = values.size() > 1 ? values[1] - values[0] : scale.hi - scale.lo;
  for (const double value : values) {
    const double y = height_of(value);
    set_color(cairo, {60, 62, 66});
    cairo_move_to(cairo, kMargin + kBarWidth, y);
    cairo_line_to(cairo, kMargin + kBarWidth + 7, y);
    cairo_stroke(cairo);
    set_color(cairo, {28, 30, 34});
    write_text(cairo, kMargin + kBarWidth + 13, y + 0.36 * kTextSize, label(value, step), kTextSize);
  }
}

Picture to_picture(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  Picture picture{static_cast<std::uint32_t>(cairo_image_surface_get_width(surface)),
                  static_cast<std::uint32_t>(cairo_image_surface_get_height(surface)),
                  {}};
  picture.pixels.reserve(std::size_t{picture.width} * picture.height);
  const unsigned char* row = cairo_image_surface_get_data(surface);
  for (std::uint32_t y = 0; y < picture.height; ++y, row += cairo_image_surface_get_stride(surface)) {
    const auto* argb = reinterpret_cast<const std::uint32_t*>(row);
    for (std::uint32_t x = 0; x < picture.width; ++x)
      picture.pixels.push_back({static_cast<std::uint8_t>(argb[x] >> 16),
                                static_cast<std::uint8_t>(argb[x] >> 8), static_cast<std::uint8_t>(argb[x])});
  }
  return picture;
}

}  // namespace

std::vector<double> ticks(double lo, double hi, int count) {
  const double rough = (hi - lo) / count;
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (const double round : {1.0, 2.0, 5.0})
    if (rough <= round * decade) {
      step = round * decade;
      break;
    }
  std::vector<double> result;
  // Counted, not added up: values far from zero may not change by a step.
  const double first = std::ceil(lo / step - 1e-9);
  for (int i = 0; i <= 2 * count; ++i) {
    const double value = (first + i) * step;
    if (value > hi + 1e-9 * step) break;
    result.push_back(value == 0 ? 0 : value);
  }
  return result;
}

Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution) {
  const double zoom = std::clamp(resolution / 1024.0, 0.6, 4.0);
  const double height = std::clamp(resolution / zoom, kMinHeight, kMaxHeight);
  const Surface2D surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(kWidth * zoom)),
                                 static_cast<int>(std::lround(height * zoom))),
      cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_t* cairo = context.get();
  set_color(cairo, {255, 255, 255});
  cairo_paint(cairo);
  cairo_scale(cairo, zoom, zoom);

  set_color(cairo, {28, 30, 34});
  write_text(cairo, kMargin, 40, text.title, kTitleSize, true);
  write_text(cairo, kMargin, 40 + kLine, text.units.empty() ? "in units of the mesh" : "in " + text.units,
             kTextSize);

  const double foot = kLine * (static_cast<double>(text.notes.size()) + (text.has_missing ? 1 : 0)) + kMargin;
  const double bottom = height - foot - kMargin;
  draw_bar(cairo, scale, kBarTop, bottom);

  double baseline = bottom + kMargin + 0.7 * kLine;
  set_color(cairo, {28, 30, 34});
  for (const std::string& note : text.notes) {
    write_text(cairo, kMargin, baseline, note, kTextSize);
    baseline += kLine;
  }
  if (text.has_missing) {
    set_color(cairo, kNoValue);
    cairo_rectangle(cairo, kMargin, baseline - kTextSize + 2, kTextSize, kTextSize);
    cairo_fill(cairo);
    set_color(cairo, {28, 30, 34});
    write_text(cairo, kMargin + kTextSize + 8, baseline, "no value (too far)", kTextSize);
  }
  if (const cairo_status_t status = cairo_status(cairo); status != CAIRO_STATUS_SUCCESS)
    throw Error(std::string("cannot draw the legend: ") + cairo_status_to_string(status) +
                "; check the units' text");
  return to_picture(surface.get());
}

}  // namespace sdm
