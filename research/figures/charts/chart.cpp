#include "research/figures/charts/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/image/pictures/legend.h"
#include "research/figures/charts/svg.h"

namespace sdm::figures {
namespace {

constexpr double kWidth = 600, kPlot = 270, kLeft = 84, kRight = 18, kTitle = 34, kEntry = 20, kFoot = 56;
constexpr double kTextSize = 14, kCharacter = 7.4;

/// One axis: its range, and where values lie within it, from 0 to 1.
struct Scale {
  bool log = false;
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;

  [[nodiscard]] bool shows(double v) const { return std::isfinite(v) && (!log || v > 0); }
  void include(double v) {
    if (shows(v)) {
      lower = std::min(lower, v);
      upper = std::max(upper, v);
    }
  }
  void finish(const Axis& axis) {
    if (!(lower <= upper)) {
      lower = log ? 1 : 0;
      upper = log ? 10 : 1;
    }
    if (log) {
      lower = std::pow(10, std::log10(lower) - 0.04);
      upper = std::pow(10, std::log10(upper) + 0.04);
      if (upper / lower < 2) {
        lower /= 1.5;
        upper *= 1.5;
      }
      return;
    }
    if (axis.from_zero) {
      lower = std::min(lower, 0.0);
      upper = std::max(upper, 0.0);
    }
    if (!(upper > lower)) upper = lower + std::max(1e-9, 0.1 * std::abs(lower));
    upper += 0.04 * (upper - lower);
    if (!axis.from_zero || lower < 0) lower -= 0.04 * (upper - lower);
  }
  [[nodiscard]] double part(double v) const {
    return log ? std::log(v / lower) / std::log(upper / lower) : (v - lower) / (upper - lower);
  }
};

struct Tick {
  double value;
  std::string label;  ///< may be empty
};

std::string log_label(double v) {
  const double exponent = std::round(std::log10(v));
  if (v >= 1e-3 && v < 1e5) return fmt::format("{:g}", v);
  const double digit = std::round(v / std::pow(10, std::floor(std::log10(v) + 1e-9)));
  return digit == 1 ? fmt::format("1e{:g}", exponent) : fmt::format("{:.0e}", v);
}

/// Powers of ten, and 2 and 5 times those while there are few decades.
std::vector<Tick> log_ticks(const Scale& scale) {
  const double decades = std::log10(scale.upper / scale.lower);
  std::vector<Tick> result;
  const int step = decades > 8 ? 2 : 1;
  for (int e = static_cast<int>(std::floor(std::log10(scale.lower))); e <= std::ceil(std::log10(scale.upper));
       ++e)
    for (const int digit : {1, 2, 5}) {
      const double v = digit * std::pow(10, e);
      if (v < scale.lower || v > scale.upper) continue;
      if (digit != 1 && decades > 3) continue;
      result.push_back({v, e % step == 0 ? log_label(v) : ""});
    }
  return result;
}

std::vector<Tick> ticks_of(const Scale& scale, int count) {
  if (scale.log) return log_ticks(scale);
  const std::vector<double> values = io::ticks(scale.lower, scale.upper, count);
  const double step = values.size() > 1 ? values[1] - values[0] : 1;
  std::vector<Tick> result;
  result.reserve(values.size());
  for (const double v : values) result.push_back({v, io::tick_label(v, step)});
  return result;
}

/// Characters rather than bytes of UTF-8.
double width_of(const std::string& text) {
  return kCharacter *
         static_cast<double>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

/// The entries of the legend, by rows.
std::vector<std::vector<std::size_t>> legend_rows(const Chart& chart) {
  std::vector<std::vector<std::size_t>> rows(1);
  double used = 0;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const double width = 46 + width_of(chart.series[i].name);
    if (used > 0 && used + width > kWidth - 40) {
      rows.emplace_back();
      used = 0;
    }
    rows.back().push_back(i);
    used += width;
  }
  return rows;
}

io::Rgb color_of(std::size_t series) {
  return kSeriesColors[series % std::size(kSeriesColors)];
}

}  // namespace

std::string to_svg(const Chart& chart) {
  Scale x{chart.x.log}, y{chart.y.log};
  for (const Series& s : chart.series)
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (x.shows(s.x[i]) && y.shows(s.y[i])) {
        x.include(s.x[i]);
        y.include(s.y[i]);
      }
  for (const Mark& mark : chart.marks) x.include(mark.x);
  x.finish(chart.x);
  y.finish(chart.y);

  const auto rows = legend_rows(chart);
  const double top = kTitle + kEntry * static_cast<double>(rows.size()) + 6, bottom = top + kPlot;
  const auto at = [&](double a, double b) {
    return Vec2{kLeft + x.part(a) * (kWidth - kLeft - kRight), bottom - y.part(b) * kPlot};
  };
  Svg svg(kWidth, bottom + kFoot, chart.title);
  svg.text({16, 22}, chart.title, 16, "start", true);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    double left = 16;
    const double middle = kTitle + kEntry * (static_cast<double>(row) + 0.5);
    for (const std::size_t i : rows[row]) {
      const Series& s = chart.series[i];
      if (s.line) svg.line({left, middle}, {left + 24, middle}, {color_of(i), 2.5, s.dashed});
      if (s.dots) svg.dot({left + 12, middle}, 4, color_of(i));
      svg.text({left + 30, middle + 5}, s.name, kTextSize);
      left += 46 + width_of(s.name);
    }
  }

  for (const auto& [value, label] : ticks_of(y, 6)) {
    const double height = bottom - y.part(value) * kPlot;
    svg.line({kLeft, height}, {kWidth - kRight, height}, {kGridColor});
    svg.text({kLeft - 8, height + 5}, label, kTextSize, "end");
  }
  for (const auto& [value, label] : ticks_of(x, 8)) {
    const double across = at(value, y.lower)[0];
    svg.line({across, top}, {across, bottom}, {kGridColor});
    svg.text({across, bottom + 19}, label, kTextSize, "middle");
  }
  const Vec2 frame[] = {
      {kLeft, top}, {kWidth - kRight, top}, {kWidth - kRight, bottom}, {kLeft, bottom}, {kLeft, top}};
  svg.path(frame, {kAxisColor});
  svg.text({(kLeft + kWidth - kRight) / 2, bottom + 44}, chart.x.label, kTextSize, "middle");
  svg.text({20, (top + bottom) / 2}, chart.y.label, kTextSize, "middle", false, -90);

  for (const Mark& mark : chart.marks) {
    const double across = at(mark.x, y.lower)[0];
    svg.line({across, top}, {across, bottom}, {kAxisColor, 1.5, true});
    const bool left_half = x.part(mark.x) < 0.6;
    svg.text({across + (left_half ? 6 : -6), top + 18}, mark.label, kTextSize, left_half ? "start" : "end");
  }
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& s = chart.series[i];
    std::vector<Vec2> points;
    for (std::size_t k = 0; k < s.x.size(); ++k)
      if (x.shows(s.x[k]) && y.shows(s.y[k])) points.push_back(at(s.x[k], s.y[k]));
    if (s.line && points.size() > 1) svg.path(points, {color_of(i), 2.2, s.dashed});
    if (s.dots || points.size() == 1)
      for (const Vec2& p : points) svg.dot(p, 3.6, color_of(i));
  }
  return std::move(svg).finished();
}

}  // namespace sdm::figures
