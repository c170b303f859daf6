// Draws with cairo into an RGB picture.
#pragma once

#include <cairo.h>

#include <memory>
#include <string>

#include "io/image/pictures/picture.h"

namespace sdm::io {

/// A white canvas. Lengths are in units of `zoom` pixels.
class Canvas {
 public:
  Canvas(double width, double height, double zoom);

  [[nodiscard]] cairo_t* cairo() { return context_.get(); }
  void set_color(Rgb color);
  /// Draws a line in the colour, width and dashes of cairo().
  void line(double x0, double y0, double x1, double y1);
  /// Draws text at (x, baseline), narrowed to fit `room`. `align`: 0: the text starts at x; 1: it ends there;
  /// 0.5: it is centred.
  void text(double x, double baseline, const std::string& text, double size, double room, bool bold = false,
            double align = 0);
  /// Copies a picture to (x, y), pixel by pixel on a canvas of zoom 1.
  void image(double x, double y, const Picture& picture);
  /// Throws sdm::Error if drawing failed; `what` names the picture in the message.
  [[nodiscard]] Picture picture(const std::string& what);

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

inline constexpr Rgb kInk{28, 30, 34}, kLineColor{60, 62, 66};

}  // namespace sdm::io
