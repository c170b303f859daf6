#include "io/image/pictures/legend.h"

#include <fmt/format.h>
#include <sdm/map.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "io/image/pictures/canvas.h"
#include "io/image/pictures/color_scale.h"
#include "summary/round_step.h"
#include "summary/verdict/limits_words.h"

namespace sdm::io {
namespace {

// Replaces a leading hyphen with a minus sign.
std::string with_minus_sign(std::string number) {
  if (number.starts_with('-')) number.replace(0, 1, "\u2212");
  return number;
}

// Lengths for a resolution of 1024; the drawing is scaled as a whole.
constexpr double kWidth = 232, kMargin = 24, kBarWidth = 30, kBarTop = 84, kMaxHeight = 1024;
constexpr double kMinHeight = 460;
constexpr double kTitleSize = 19, kTextSize = 15, kLine = 23;

// Shrinks long text to fit the picture.
void write_text(Canvas& canvas, double x, double baseline, const std::string& text, double size,
                bool bold = false) {
  canvas.text(x, baseline, text, size, kWidth - x - kMargin / 2, bold);
}

void draw_bar(Canvas& canvas, const ColorScale& scale, const std::vector<ScaleLabel>& labels, double top,
              double bottom) {
  cairo_t* cairo = canvas.cairo();
  const auto height_of = [&](double d) {
    return bottom - (d - scale.lower) / (scale.upper - scale.lower) * (bottom - top);
  };
  constexpr int kSteps = 4096;  // finer than any pixel of the bar
  // Every pixel has the colour of one step, unblended with the background, if there is no antialiasing. Each
  // step extends below the next one, which covers it, so rounding leaves no seams.
  cairo_set_antialias(cairo, CAIRO_ANTIALIAS_NONE);
  for (int i = 0; i < kSteps; ++i) {
    const double foot = bottom - i * (bottom - top) / kSteps, head = std::max(top, foot - 3);
    canvas.set_color(scale(scale.lower + (i + 0.5) / kSteps * (scale.upper - scale.lower)));
    cairo_rectangle(cairo, kMargin, head, kBarWidth, foot - head);
    cairo_fill(cairo);
  }
  cairo_set_antialias(cairo, CAIRO_ANTIALIAS_DEFAULT);
  canvas.set_color(kLineColor);
  cairo_set_line_width(cairo, 1);
  cairo_rectangle(cairo, kMargin, top, kBarWidth, bottom - top);
  cairo_stroke(cairo);

  for (const auto& [value, text, is_limit] : labels) {
    const double y = height_of(value);
    if (is_limit) {
      canvas.set_color(kInk);
      canvas.line(kMargin, y, kMargin + kBarWidth, y);
      cairo_new_path(cairo);
    }
    canvas.set_color(kLineColor);
    cairo_move_to(cairo, kMargin + kBarWidth, y);
    cairo_line_to(cairo, kMargin + kBarWidth + 7, y);
    cairo_stroke(cairo);
    canvas.set_color(kInk);
    write_text(canvas, kMargin + kBarWidth + 13, y + 0.36 * kTextSize, text, kTextSize, is_limit);
  }
}

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

std::vector<double> ticks(double lo, double hi, int count) {
  const RoundStep step((hi - lo) / count);
  std::vector<double> result;
  // Multiplied rather than accumulated: far from zero, adding a step may not change a value.
  const double first = std::ceil(lo / step.size() - 1e-9);
  for (int i = 0; i <= 2 * count; ++i) {
    const double value = step.multiple(first + i);
    if (value > hi + 1e-9 * step.size()) break;
    result.push_back(value == 0 ? 0 : value);
  }
  return result;
}

std::string tick_label(double value, double step) {
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4)
    return with_minus_sign(fmt::format(
        "{:.{}e}", value,
        std::clamp(static_cast<int>(std::floor(std::log10(size)) - std::floor(std::log10(step))), 0, 15)));
  return with_minus_sign(fmt::format(
      "{:.{}f}", value, std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15)));
}

std::string value_label(double value) {
  return with_minus_sign(fmt::format("{:.4g}", value));
}

std::vector<ScaleLabel> scale_labels(const ColorScale& scale) {
  const auto [lo, hi] = std::pair(scale.lower, scale.upper);
  const std::vector<double> round = ticks(lo, hi, kScaleSteps);
  const double step = round.size() > 1 ? round[1] - round[0] : hi - lo;
  std::vector<ScaleLabel> labels;
  // What is named first keeps its neighbours away; a limit is at least a line.
  const auto add = [&](double value, bool is_limit) {
    const bool close = std::ranges::any_of(
        labels, [&](const ScaleLabel& l) { return std::abs(l.value - value) < rules::kApart * (hi - lo); });
    if (close && !is_limit) return;
    const double steps = value / step;
    const bool is_round = std::abs(steps - std::round(steps)) < 1e-6;
    labels.push_back({value, close ? "" : is_round ? tick_label(value, step) : value_label(value), is_limit});
  };
  add(lo, false);
  add(hi, false);
  if (scale.tolerance)
    for (const double limit : {scale.tolerance->lower, scale.tolerance->upper})
      if (limit > lo && limit < hi) add(limit, true);
  for (const double value : round) add(value, false);
  std::ranges::sort(labels, {}, &ScaleLabel::value);
  return labels;
}

LegendText legend_text(const DistanceMap& map, double least, double most, const ColorScale& scale,
                       const std::string& units) {
  const bool thickness = map.measured.kind == DistanceKind::thickness;
  const bool is_signed = !thickness && map.sign.method != SignMethod::none;
  LegendText text{
      thickness ? "Thickness" : "Distance", units, {}, map.beyond_max_distance + map.without_match > 0};
  if (least <= most) text.notes = {"min  " + value_label(least), "max  " + value_label(most)};
  if (const auto& t = scale.tolerance) {
    text.notes.push_back((t->lower == -t->upper ? "green: within " : "green: ") +
                         summary::limits_words(*t, is_signed, value_label));
    text.notes.emplace_back(std::isinf(t->lower) || std::isinf(t->upper) ? "darker: nearer the limit"
                                                                         : "darker: nearer a limit");
  }
  if (!thickness)
    text.notes.push_back(map.sign.method == SignMethod::none   ? "unsigned"
                         : map.sign.method == SignMethod::side ? "negative: behind"
                                                               : "negative: inside");
  // An empty line otherwise: pictures of a sequence have bars of one length.
  text.notes.emplace_back(least < scale.lower || most > scale.upper ? "beyond: as the ends" : "");
  return text;
}

Picture draw_legend(const ColorScale& scale, const LegendText& text, std::uint32_t resolution) {
  const double zoom = std::clamp(resolution / 1024.0, 0.6, 4.0);
  const double height = std::clamp(resolution / zoom, kMinHeight, kMaxHeight);
  Canvas canvas(kWidth, height, zoom);
  cairo_t* cairo = canvas.cairo();

  canvas.set_color(kInk);
  write_text(canvas, kMargin, 40, text.title, kTitleSize, true);
  write_text(canvas, kMargin, 40 + kLine,
             !text.subtitle.empty() ? text.subtitle
             : text.units.empty()   ? "in units of the mesh"
                                    : "in " + text.units,
             kTextSize);

  const double foot = kLine * (static_cast<double>(text.notes.size()) + (text.has_missing ? 1 : 0)) + kMargin;
  const double bottom = height - foot - kMargin;
  draw_bar(canvas, scale, text.labels.empty() ? scale_labels(scale) : text.labels, kBarTop, bottom);

  double baseline = bottom + kMargin + 0.7 * kLine;
  canvas.set_color(kInk);
  for (const std::string& note : text.notes) {
    write_text(canvas, kMargin, baseline, note, kTextSize);
    baseline += kLine;
  }
  if (text.has_missing) {
    canvas.set_color(kNoValue);
    cairo_rectangle(cairo, kMargin, baseline - kTextSize + 2, kTextSize, kTextSize);
    cairo_fill(cairo);
    canvas.set_color(kInk);
    write_text(canvas, kMargin + kTextSize + 8, baseline, "nothing in range", kTextSize);
  }
  return canvas.picture("the legend");
}

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
