#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/memory.h"
#include "io/image/pictures/canvas.h"
#include "io/image/pictures/legend.h"
#include "io/image/pictures/picture.h"

namespace sdm {

using namespace io;

namespace {

constexpr double kWidth = 900, kPanel = 220, kLeft = 90, kRight = 24, kTop = 40, kFoot = 26, kAxis = 40;
constexpr double kTitleSize = 15, kTextSize = 12, kZoom = 1.5;
constexpr Rgb kGrid{228, 230, 233};
// The palette of Okabe and Ito, distinguishable by colour-blind readers.
constexpr Rgb kColors[] = {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {86, 180, 233}};

struct Range {
  double lower = kInfinity, upper = -lower;

  void include(std::span<const double> values) {
    for (const double v : values)
      if (std::isfinite(v)) {
        lower = std::min(lower, v);
        upper = std::max(upper, v);
      }
  }
  // Makes the range nonempty, even if there are no values or only one.
  void widen() {
    if (!(lower <= upper)) {
      lower = 0;
      upper = 1;
    }
    const double least = std::max(1e-9 * std::max(std::abs(lower), std::abs(upper)), 1e-30);
    if (upper - lower < least) {
      lower -= least > 1e-30 ? 0.05 * std::abs(lower) : 0.5;
      upper += least > 1e-30 ? 0.05 * std::abs(upper) : 0.5;
    }
  }
  [[nodiscard]] double part(double v) const { return (v - lower) / (upper - lower); }
};

// The axes of a panel, relative to its top left corner.
struct Frame {
  double top;
  Range x, y;

  [[nodiscard]] double right() const { return kWidth - kRight; }
  [[nodiscard]] double bottom() const { return top + kPanel - kTop - kFoot; }
  [[nodiscard]] double across(double v) const { return kLeft + x.part(v) * (right() - kLeft); }
  [[nodiscard]] double up(double v) const { return bottom() - y.part(v) * (bottom() - top); }
};

void draw_grid(Canvas& canvas, const Frame& frame) {
  cairo_set_line_width(canvas.cairo(), 1);
  const std::vector<double> heights = ticks(frame.y.lower, frame.y.upper, 5),
                            places = ticks(frame.x.lower, frame.x.upper, 10);
  const auto step = [](const std::vector<double>& t) { return t.size() > 1 ? t[1] - t[0] : 1; };
  for (const double v : heights) {
    canvas.set_color(kGrid);
    canvas.line(kLeft, frame.up(v), frame.right(), frame.up(v));
    canvas.set_color(kInk);
    canvas.text(kLeft - 8, frame.up(v) + 0.36 * kTextSize, tick_label(v, step(heights)), kTextSize,
                kLeft - 12, false, 1);
  }
  for (const double v : places) {
    canvas.set_color(kGrid);
    canvas.line(frame.across(v), frame.top, frame.across(v), frame.bottom());
    canvas.set_color(kInk);
    canvas.text(frame.across(v), frame.bottom() + 1.4 * kTextSize, tick_label(v, step(places)), kTextSize, 60,
                false, 0.5);
  }
  canvas.set_color(kLineColor);
  cairo_rectangle(canvas.cairo(), kLeft, frame.top, frame.right() - kLeft, frame.bottom() - frame.top);
  cairo_stroke(canvas.cairo());
}

void draw_curve(Canvas& canvas, const Frame& frame, std::span<const double> places,
                std::span<const double> values) {
  cairo_t* cairo = canvas.cairo();
  cairo_set_line_width(cairo, 1.8);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  bool drawing = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool here = std::isfinite(values[i]) && std::isfinite(places[i]);
    if (here && drawing) cairo_line_to(cairo, frame.across(places[i]), frame.up(values[i]));
    if (here && !drawing) {  // an isolated value between gaps is drawn as a dot
      cairo_move_to(cairo, frame.across(places[i]), frame.up(values[i]));
      cairo_line_to(cairo, frame.across(places[i]), frame.up(values[i]));
    }
    drawing = here;
  }
  cairo_stroke(cairo);
}

void draw_panel(Canvas& canvas, double top, std::span<const double> places, const PlotPanel& panel) {
  Frame frame{top + kTop, {}, {}};
  frame.x.include(places);
  for (const Curve& curve : panel.curves) frame.y.include(curve.values);
  frame.x.widen();
  frame.y.widen();
  canvas.set_color(kInk);
  canvas.text(kLeft, top + kTop - 12, panel.title, kTitleSize, kWidth / 2, true);
  draw_grid(canvas, frame);
  double name_end = frame.right();
  for (std::size_t c = panel.curves.size(); c-- > 0;) {
    const Curve& curve = panel.curves[c];
    canvas.set_color(kColors[c % std::size(kColors)]);
    draw_curve(canvas, frame, places, curve.values);
    if (panel.curves.size() == 1) continue;
    constexpr double kName = 110;
    cairo_set_line_width(canvas.cairo(), 3);
    canvas.line(name_end - kName, top + kTop - 17, name_end - kName + 18, top + kTop - 17);
    canvas.set_color(kInk);
    canvas.text(name_end - kName + 24, top + kTop - 12, curve.name, kTextSize, kName - 30);
    name_end -= kName;
  }
}

}  // namespace

void write_plot_png(const std::filesystem::path& file, const std::string& axis,
                    std::span<const double> places, std::span<const PlotPanel> panels) try {
  for (const PlotPanel& panel : panels)
    for (const Curve& curve : panel.curves)
      if (curve.values.size() != places.size())
        throw Error(fmt::format("cannot plot '{}': it has {} values for {} places", curve.name,
                                curve.values.size(), places.size()));
  const double height = kPanel * static_cast<double>(panels.size()) + kAxis;
  Canvas canvas(kWidth, height, kZoom);
  for (std::size_t i = 0; i < panels.size(); ++i)
    draw_panel(canvas, kPanel * static_cast<double>(i), places, panels[i]);
  canvas.set_color(kInk);
  canvas.text((kLeft + kWidth - kRight) / 2, height - 16, axis, kTextSize, kWidth / 2, false, 0.5);
  write_picture(file, canvas.picture("the plot"));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
