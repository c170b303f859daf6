// Drawings as SVG.
#pragma once

#include <sdm/types.h>

#include <span>
#include <string>
#include <string_view>

#include "io/image/pictures/color_scale.h"

namespace sdm::figures {

/// Text with the characters escaped that HTML and SVG reserve.
[[nodiscard]] std::string escaped(std::string_view text);
/// "#rrggbb".
[[nodiscard]] std::string css(io::Rgb color);

inline constexpr io::Rgb kText{28, 30, 34}, kAxisColor{90, 94, 100}, kGridColor{226, 228, 232};
/// The palette of Okabe and Ito but for its yellow, distinguishable by colour-blind readers.
inline constexpr io::Rgb kSeriesColors[] = {{0, 114, 178},  {213, 94, 0},  {0, 158, 115},  {204, 121, 167},
                                            {86, 180, 233}, {230, 159, 0}, {120, 124, 130}};

struct Stroke {
  io::Rgb color = kText;
  double width = 1;
  bool dashed = false;
};

/// A drawing in units of about a pixel, x to the right and y down. Lengths and positions are rounded to
/// 1/100.
class Svg {
 public:
  /// `name`: what the picture shows, for those who cannot see it.
  Svg(double width, double height, std::string_view name);

  void line(const Vec2& a, const Vec2& b, const Stroke& stroke);
  void path(std::span<const Vec2> points, const Stroke& stroke);
  void polygon(std::span<const Vec2> corners, io::Rgb fill, double opacity, const Stroke& stroke);
  void dot(const Vec2& centre, double radius, io::Rgb fill);
  /// With a head of 6 units; only the head is drawn for shorter ones.
  void arrow(const Vec2& from, const Vec2& to, const Stroke& stroke);
  /// `align`: "start", "middle" or "end".
  void text(const Vec2& at, std::string_view text, double size = 14, std::string_view align = "start",
            bool bold = false, double degrees = 0);

  [[nodiscard]] std::string finished() &&;

 private:
  std::string text_;
};

}  // namespace sdm::figures
