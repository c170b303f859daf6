// The normals by which faces of O1 choose faces of O2 that face the same way.
#pragma once

#include <sdm/mesh.h>

#include <vector>

namespace sdm::map {

/// The unit normal of each face; 0 for faces without area. If the mesh is closed and orientable, they are
/// outward, as Sites orients O2, whichever way its faces are wound; otherwise by the order of their corners.
/// Cost: O(n log n), all cores.
[[nodiscard]] std::vector<Vec3> outward_normals(const Mesh& mesh);

}  // namespace sdm::map
