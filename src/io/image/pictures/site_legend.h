// The legend beside a Voronoi diagram: what its colours distinguish.
#pragma once

#include <cstdint>

#include "io/image/pictures/picture.h"

namespace sdm::io {

/// Draws colours of faces, edges and vertices of O2, as of site_color(), with their names, for a picture of
/// `rows` rows; `has_missing`: also the colour of texels without a value.
[[nodiscard]] Picture draw_site_legend(std::uint32_t rows, bool has_missing);

}  // namespace sdm::io
