// The materials of OBJ.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/polygons/polygon_materials.h"

namespace sdm::io {

/// Adds the materials of an MTL file: Kd and map_Kd, Ke and map_Ke, d and Tr, Pm, Pr, and norm. Colours are
/// in sRGB, and a picture replaces its colour, as programs have it that write such files. Pictures are looked
/// up in `folder`. One that cannot be had is left out, with a note that names it. Throws sdm::Error for
/// numbers that are none.
void read_mtl(std::string_view text, const std::filesystem::path& folder, PolygonMaterials& materials,
              std::vector<std::string>& notes);

}  // namespace sdm::io
