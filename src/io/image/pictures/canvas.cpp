#include "io/image/pictures/canvas.h"

#include <sdm/error.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>

#include "io/image/pictures/font.h"

namespace sdm::io {
namespace {

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

Canvas::Canvas(double width, double height, double zoom)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(width * zoom)),
                                          static_cast<int>(std::lround(height * zoom))),
               cairo_surface_destroy),
      context_(cairo_create(surface_.get()), cairo_destroy) {
  set_color({255, 255, 255});
  cairo_paint(cairo());
  cairo_scale(cairo(), zoom, zoom);
}

void Canvas::set_color(Rgb color) {
  cairo_set_source_rgb(cairo(), color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

void Canvas::text(double x, double baseline, const std::string& text, double size, double room, bool bold,
                  double align) {
  select_font(cairo(), bold);
  cairo_set_font_size(cairo(), size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo(), text.c_str(), &extents);
  const double shrink = extents.x_advance > room ? room / extents.x_advance : 1;
  cairo_set_font_size(cairo(), size * shrink);
  cairo_move_to(cairo(), x - align * shrink * extents.x_advance, baseline);
  cairo_show_text(cairo(), text.c_str());
}

void Canvas::line(double x0, double y0, double x1, double y1) {
  cairo_move_to(cairo(), x0, y0);
  cairo_line_to(cairo(), x1, y1);
  cairo_stroke(cairo());
}

void Canvas::image(double x, double y, const Picture& picture) {
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> image(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(picture.width),
                                 static_cast<int>(picture.height)),
      cairo_surface_destroy);
  unsigned char* row = cairo_image_surface_get_data(image.get());
  if (row == nullptr) throw std::bad_alloc();
  const Rgb* pixel = picture.pixels.data();
  for (std::uint32_t i = 0; i < picture.height; ++i, row += cairo_image_surface_get_stride(image.get())) {
    auto* rgb = reinterpret_cast<std::uint32_t*>(row);
    for (std::uint32_t k = 0; k < picture.width; ++k, ++pixel)
      rgb[k] = std::uint32_t{pixel->r} << 16 | std::uint32_t{pixel->g} << 8 | pixel->b;
  }
  cairo_surface_mark_dirty(image.get());
  cairo_set_source_surface(cairo(), image.get(), x, y);
  cairo_paint(cairo());
}

Picture Canvas::picture(const std::string& what) {
  if (const cairo_status_t status = cairo_status(cairo()); status != CAIRO_STATUS_SUCCESS)
    throw Error("cannot draw " + what + ": " + cairo_status_to_string(status) +
                "; check the text of the units");
  return to_picture(surface_.get());
}

}  // namespace sdm::io
