// Faces that close an open mesh.
#pragma once

#include <sdm/types.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "sites/sites_data.h"

namespace sdm::inside {

/// Triangles with the corners of the mesh that, together with its faces as they are oriented, form a closed
/// surface: each edge is passed as often in one direction as in the other, where vertices at the same
/// position are one. Their number is that of the boundary edges, counted by how often each is passed more in
/// one direction, less at least one for each loop of them. None if they are more than `most`.
/// Cost: O(n), plus O(b log b) for b boundary edges.
[[nodiscard]] std::optional<std::vector<Triangle>> closing_faces(const sites::SitesData& sites,
                                                                 std::size_t most);

}  // namespace sdm::inside
