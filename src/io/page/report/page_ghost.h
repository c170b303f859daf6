// The other mesh, as report.html shows it.
#pragma once

#include <sdm/doubts.h>
#include <sdm/mesh.h>

#include <nlohmann/json.hpp>

#include "io/page/report/packed_arrays.h"

namespace sdm::io {

/// Adds the other mesh: `ghost_position` and `ghost_triangle`; nothing but its box if there are more than
/// `most` triangles. With its coverage, also `ghost_covered` (of each triangle, 1 if it is covered), and
/// faces that are covered in part are their pieces, or if these are too many, covered if half of their area
/// is. Returns its measures.
[[nodiscard]] nlohmann::ordered_json add_ghost(PackedArrays& arrays, const Mesh& mesh,
                                               const CoverageMap* coverage, std::size_t most);

}  // namespace sdm::io
