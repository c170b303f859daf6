#include "research/figures/charts/svg.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace sdm::figures {
namespace {

std::string coordinate(double x) {
  const double rounded = std::round(100 * x) / 100;
  return fmt::format("{}", rounded == 0 ? 0.0 : rounded);
}

std::string points_of(std::span<const Vec2> points) {
  std::string result;
  for (const auto& [x, y] : points) {
    if (!result.empty()) result += ' ';
    result += coordinate(x) + ',' + coordinate(y);
  }
  return result;
}

// The colours of text, axes and grids are those of the page, which is light or dark.
std::string of_page(io::Rgb color) {
  if (color == kText) return "var(--ink)";
  if (color == kAxisColor) return "var(--axis)";
  return color == kGridColor ? "var(--grid)" : css(color);
}

std::string attributes(const Stroke& stroke) {
  return fmt::format(R"(stroke="{}" stroke-width="{}"{})", of_page(stroke.color), coordinate(stroke.width),
                     stroke.dashed ? R"( stroke-dasharray="7 5")" : "");
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string css(io::Rgb c) {
  return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

Svg::Svg(double width, double height, std::string_view name)
    : text_(fmt::format(R"(<svg viewBox="0 0 {} {}" width="{}" role="img" aria-label="{}">)"
                        "\n",
                        coordinate(width), coordinate(height), coordinate(1.2 * width), escaped(name))) {}

void Svg::line(const Vec2& a, const Vec2& b, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(text_),
                 R"(<line x1="{}" y1="{}" x2="{}" y2="{}" {}/>)"
                 "\n",
                 coordinate(a[0]), coordinate(a[1]), coordinate(b[0]), coordinate(b[1]), attributes(stroke));
}

void Svg::path(std::span<const Vec2> points, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(text_),
                 R"(<polyline fill="none" stroke-linejoin="round" points="{}" {}/>)"
                 "\n",
                 points_of(points), attributes(stroke));
}

void Svg::polygon(std::span<const Vec2> corners, io::Rgb fill, double opacity, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(text_),
                 R"(<polygon fill="{}" fill-opacity="{}" points="{}" {}/>)"
                 "\n",
                 css(fill), coordinate(opacity), points_of(corners), attributes(stroke));
}

void Svg::dot(const Vec2& centre, double radius, io::Rgb fill) {
  fmt::format_to(std::back_inserter(text_),
                 R"(<circle cx="{}" cy="{}" r="{}" fill="{}"/>)"
                 "\n",
                 coordinate(centre[0]), coordinate(centre[1]), coordinate(radius), of_page(fill));
}

void Svg::arrow(const Vec2& from, const Vec2& to, const Stroke& stroke) {
  constexpr double kHead = 6;
  const double x = to[0] - from[0], y = to[1] - from[1], length = std::hypot(x, y);
  if (length == 0) return;
  const Vec2 along{kHead * x / length, kHead * y / length}, aside{-0.4 * along[1], 0.4 * along[0]};
  const Vec2 neck{to[0] - along[0], to[1] - along[1]};
  if (length > kHead) line(from, neck, stroke);
  const Vec2 head[] = {
      to, {neck[0] + aside[0], neck[1] + aside[1]}, {neck[0] - aside[0], neck[1] - aside[1]}};
  fmt::format_to(std::back_inserter(text_),
                 R"(<polygon fill="{}" points="{}" {}/>)"
                 "\n",
                 of_page(stroke.color), points_of(head), attributes({stroke.color, 0.5}));
}

void Svg::text(const Vec2& at, std::string_view text, double size, std::string_view align, bool bold,
               double degrees) {
  std::string turn;
  if (degrees != 0)
    turn = fmt::format(" transform=\"rotate({} {} {})\"", coordinate(degrees), coordinate(at[0]),
                       coordinate(at[1]));
  fmt::format_to(std::back_inserter(text_),
                 R"(<text x="{}" y="{}" font-size="{}" text-anchor="{}"{}{} fill="{}">{}</text>)"
                 "\n",
                 coordinate(at[0]), coordinate(at[1]), coordinate(size), align,
                 bold ? R"( font-weight="600")" : "", turn, of_page(kText), escaped(text));
}

std::string Svg::finished() && {
  return std::move(text_) + "</svg>\n";
}

}  // namespace sdm::figures
