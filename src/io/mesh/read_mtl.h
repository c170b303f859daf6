// The materials of OBJ.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/mesh/polygons/polygon_materials.h"

namespace sdm::io {

/// Adds the materials of an MTL file: Kd and map_Kd, Ke and map_Ke, d and Tr, Pm, Pr, and norm. Colours are
/// in sRGB, and a picture replaces its colour, as programs have it that write such files. Pictures are looked
/// up in `folder`. What cannot be had is left out, which the materials have notes of.
void read_mtl(std::string_view text, const std::filesystem::path& folder, PolygonMaterials& materials);

}  // namespace sdm::io
