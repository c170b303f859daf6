// Faces that close an open mesh.
#pragma once

#include <sdm/types.h>

#include <vector>

#include "sites/sites_data.h"

namespace sdm::inside {

/// Triangles with the corners of the mesh that, together with its faces as they are oriented, form a closed
/// surface: each edge is passed as often in one direction as in the other, where vertices at the same
/// position are one. Their number is that of the boundary edges, counted by how often each is passed more in
/// one direction, less at least one for each loop of them. Cost: O(n), plus O(b log b) for b boundary edges.
[[nodiscard]] std::vector<Triangle> closing_faces(const sites::SitesData& sites);

}  // namespace sdm::inside
