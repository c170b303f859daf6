#include "scene/letter_outline.h"

#include <ft2build.h>
#include <sdm/error.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <type_traits>

#include "core/vec.h"

namespace sdm {
namespace {

double length(const Vec2& a) {
  return std::sqrt(dot(a, a));
}

// FreeType walks along an outline; curves become short sides.
int move_to(const FT_Vector* to, void* contours) {
  static_cast<std::vector<Contour>*>(contours)->push_back(
      {{static_cast<double>(to->x), static_cast<double>(to->y)}});
  return 0;
}
int line_to(const FT_Vector* to, void* contours) {
  static_cast<std::vector<Contour>*>(contours)->back().push_back(
      {static_cast<double>(to->x), static_cast<double>(to->y)});
  return 0;
}
int conic_to(const FT_Vector* control, const FT_Vector* to, void* contours) {
  constexpr int kSides = 16;
  Contour& contour = static_cast<std::vector<Contour>*>(contours)->back();
  const Vec2 a = contour.back(), b{static_cast<double>(control->x), static_cast<double>(control->y)},
             c{static_cast<double>(to->x), static_cast<double>(to->y)};
  for (int i = 1; i <= kSides; ++i) {
    const double t = static_cast<double>(i) / kSides;
    contour.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c);
  }
  return 0;
}

template <auto Release>
struct Releaser {
  template <class Handle>
  void operator()(Handle handle) const {
    Release(handle);
  }
};
using Library = std::unique_ptr<std::remove_pointer_t<FT_Library>, Releaser<FT_Done_FreeType>>;
using Face = std::unique_ptr<std::remove_pointer_t<FT_Face>, Releaser<FT_Done_Face>>;

/// In units of the font.
std::vector<Contour> font_outline(char character) {
  FT_Library library_handle = nullptr;
  if (FT_Init_FreeType(&library_handle) != 0) throw Error("FreeType does not start");
  const Library library(library_handle);
  FT_Face face_handle = nullptr;
  if (FT_New_Face(library.get(), SDM_LETTER_FONT, 0, &face_handle) != 0)
    throw Error("cannot read the font " SDM_LETTER_FONT
                "; install the DejaVu fonts (Debian: fonts-dejavu-core)");
  const Face face(face_handle);

  std::vector<Contour> contours;
  FT_Outline_Funcs pen{};  // without cubic curves, which TrueType fonts do not have
  pen.move_to = move_to, pen.line_to = line_to, pen.conic_to = conic_to;
  if (FT_Load_Char(face.get(), static_cast<unsigned char>(character), FT_LOAD_NO_SCALE) != 0 ||
      FT_Outline_Decompose(&face->glyph->outline, &pen, &contours) != 0 || contours.empty())
    throw Error(std::string("the font has no shape for '") + character + "'");
  for (Contour& contour : contours) {
    if (contour.back() == contour.front()) contour.pop_back();
    std::ranges::reverse(contour);  // TrueType's shapes are on the right
  }
  return contours;
}

/// Turns by more than the sides of a curve do.
bool is_corner(const Contour& contour, std::size_t i) {
  const std::size_t n = contour.size();
  const Vec2 before = contour[i] - contour[(i + n - 1) % n], after = contour[(i + 1) % n] - contour[i];
  return std::abs(std::atan2(cross(before, after), dot(before, after))) > std::numbers::pi / 6;
}

/// Appends the start of each of the equal parts, about `spacing` long, that the path is cut into.
void append_parts(const Contour& path, double spacing, Contour& out) {
  double total = 0;
  for (std::size_t i = 1; i < path.size(); ++i) total += length(path[i] - path[i - 1]);
  const double parts = std::max(1.0, std::round(total / spacing));
  double part = 0, walked = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double side = length(path[i] - path[i - 1]);
    for (; part < parts && total * part / parts < walked + side; ++part)
      out.push_back(path[i - 1] + ((total * part / parts - walked) / side) * (path[i] - path[i - 1]));
    walked += side;
  }
}

Contour resample(Contour contour, double spacing) {
  for (std::size_t i = 0; i < contour.size(); ++i)
    if (is_corner(contour, i)) {
      std::ranges::rotate(contour, contour.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  Contour result, path;  // from corner to corner, or all around
  for (std::size_t i = 0; i < contour.size(); ++i) {
    path.push_back(contour[i]);
    const std::size_t next = (i + 1) % contour.size();
    if (next != 0 && !is_corner(contour, next)) continue;
    path.push_back(contour[next]);
    append_parts(path, spacing, result);
    path.clear();
  }
  return result;
}

}  // namespace

std::vector<Contour> letter_outline(char character, double spacing) {
  std::vector<Contour> contours = font_outline(character);
  Vec2 lo = contours[0][0], hi = lo;
  for (const Contour& contour : contours)
    for (const Vec2& p : contour)
      for (int k = 0; k < 2; ++k) lo[k] = std::min(lo[k], p[k]), hi[k] = std::max(hi[k], p[k]);
  for (Contour& contour : contours) {
    for (Vec2& p : contour) p = (1 / (hi[1] - lo[1])) * (p - 0.5 * (lo + hi));
    contour = resample(std::move(contour), spacing);
  }
  return contours;
}

}  // namespace sdm
