// The font of the text of pictures.
#pragma once

#include <cairo.h>

namespace sdm::io {

/// Selects DejaVu Sans, which the library contains, so that text has the same pixels everywhere, and needs no
/// fonts of the machine. Built without it (see CMakeLists.txt), the font of this name that fontconfig finds,
/// or another one.
void select_font(cairo_t* cairo, bool bold);

}  // namespace sdm::io
