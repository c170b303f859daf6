// Where a mesh may be far from another one.
#pragma once

#include <sdm/execution.h>
#include <sdm/mesh.h>

#include "sites/sites_data.h"

namespace sdm::simplify {

/// Triangles that cover all points of the mesh with a distance to B above `limit`, up to rounding of their
/// corners: at most 1e-13 of the coordinates. Faces are divided into four until they are as small as the
/// faces of B near them; then what is above such a face is cut off. What is surely within the limit is left
/// out; the rest is returned once no division helps. The middles of all pieces are measured together, which
/// costs a tenth of single searches.
[[nodiscard]] Mesh parts_above(const Mesh& mesh, const sites::SitesData& b, double limit,
                               const Progress& progress);

}  // namespace sdm::simplify
