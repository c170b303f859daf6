// A detailed mesh as the page of `sdm bake` shows it: triangles with colours and normals at their corners.
#pragma once

#include <sdm/bake_files.h>

#include <nlohmann/json.hpp>

#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_numbers.h"

namespace sdm::io {

/// Adds the triangles. Arrays: `high_triangle` (corner_codes()), and for each vertex `high_position` (three,
/// in steps), `high_normal` (octahedral) and `high_color` (red, green and blue in sRGB, 8 bits each, red the
/// lowest). Returns how many `triangles` there are of how many of the mesh, and into how many parts each side
/// of a face is divided; `fewer`: of a coarser copy.
[[nodiscard]] nlohmann::ordered_json add_detailed(PackedArrays& arrays, const BakedFrom& from,
                                                  const Steps& steps);

}  // namespace sdm::io
