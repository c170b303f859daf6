#include "io/image/pictures/font.h"

#ifdef SDM_EMBEDDED_FONTS

#include <cairo-ft.h>
#include <sdm/error.h>

#include <array>

#include "io/image/pictures/embedded_fonts.h"

namespace sdm::io {
namespace {

/// The regular and the bold face. They last as long as the process: cairo keeps what it draws with.
struct Faces {
  std::array<cairo_font_face_t*, 2> faces{};

  Faces() {
    FT_Library library = nullptr;
    if (FT_Init_FreeType(&library) != 0) throw Error("the font of pictures cannot be loaded");
    faces = {loaded(library, kRegularTtf), loaded(library, kBoldTtf)};
  }

 private:
  static cairo_font_face_t* loaded(FT_Library library, const EmbeddedFile& file) {
    FT_Face face = nullptr;
    if (FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(file.bytes.data()),
                           static_cast<FT_Long>(file.bytes.size()), 0, &face) != 0)
      throw Error("the font of pictures cannot be loaded");
    return cairo_ft_font_face_create_for_ft_face(face, 0);
  }
};

}  // namespace

void select_font(cairo_t* cairo, bool bold) {
  static const Faces* const faces = new Faces;
  cairo_set_font_face(cairo, faces->faces[bold ? 1 : 0]);
  // As Debian configures fontconfig.
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

}  // namespace sdm::io

#else

namespace sdm::io {

void select_font(cairo_t* cairo, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
}

}  // namespace sdm::io

#endif
