// The part as report.html shows it: its triangles, and the values of its texels.
#pragma once

#include <sdm/map.h>
#include <sdm/mesh_attributes.h>
#include <sdm/surface.h>

#include <nlohmann/json.hpp>
#include <span>

#include "io/page/report/packed_arrays.h"

namespace sdm::io {

/// Adds the map: texel by texel, or if it has more than `largest` a side, a texel of each square, as pictures
/// show it. Arrays:
/// `chart` (of all texels of the page: 1 + the chart of the owner, 0 without one), and of the owned texels in
/// order those of page_channels.h and `site` (4 · number + type, 0xFFFFFFFF without one; missing if a number
/// does not fit). Returns its measures.
[[nodiscard]] nlohmann::ordered_json add_map(PackedArrays& arrays, const Surface& surface,
                                             const DistanceMap& map, std::uint32_t largest);

/// Adds the triangles of the measured mesh. Arrays: `position` (three a vertex, in steps from the origin),
/// `place` (two, its atlas coordinates in 1/64 of a texel of the page), `normal` (octahedral, two bytes),
/// `vertex_distance`, `triangle` (for each corner, how many vertices its vertex was before the first one that
/// has not occurred yet), `triangle_chart` (1 + the chart of each triangle), and `triangle_name_0` and so on
/// for each kind of names (1 + the name of each triangle, 0 without one). If there are more than `most`
/// triangles, the vertices are fewer ones of the mesh, and without `place` and what belongs to triangles.
/// `largest`: as for add_map(). Returns its measures.
[[nodiscard]] nlohmann::ordered_json add_model(PackedArrays& arrays, const Surface& surface,
                                               std::span<const float> vertex_distances,
                                               std::span<const FaceNames> names, std::uint32_t largest,
                                               std::size_t most);

}  // namespace sdm::io
