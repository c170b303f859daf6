// A detailed mesh as the page of `sdm bake` shows it: triangles with colours and normals at their corners.
#pragma once

#include <sdm/bake_files.h>

#include <nlohmann/json.hpp>

#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_numbers.h"

namespace sdm {

/// Arrays: `high_triangle` (corner_codes()), and for each vertex `high_position` (three, in steps),
/// `high_normal` (octahedral), `high_color` (red, green and blue in sRGB, 8 bits each, red the lowest) and,
/// unless all is rough and no metal, `high_surface` (as metallic_roughness.png: roughness in green, metallic
/// in blue).
struct DetailedView::Data {
  io::Steps steps;  ///< of both meshes
  io::PackedArrays arrays{};
  /// How many `triangles` there are of how many of the mesh, and into how many parts each side of a face is
  /// divided; `fewer`: of a coarser copy.
  nlohmann::ordered_json counts{};
};

}  // namespace sdm
