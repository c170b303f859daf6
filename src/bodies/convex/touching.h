// Whether convex solids that nearly touch have a point in common.
#pragma once

#include <optional>

#include "bodies/convex/support_search.h"
#include "bodies/pairs/mesh_pair.h"

namespace sdm::convex {

/// Decides exactly, by the vertices in space, whether two convex solids have a point in common: two faces
/// near the closest points intersect, or all vertices of O1 and all of O2 are on different sides of a plane,
/// those of one of them strictly, which is that of such a face or contains an edge of O1. Empty where neither
/// is found.
///
/// `scale`: of the pose. `simplex`: of points near the closest ones. `rounding`: a thousand times the error
/// of the coordinates of a posed vertex. Cost: some faces and vertices about those of the simplex.
[[nodiscard]] std::optional<bool> touching(const ConvexMesh& o1, const ConvexMesh& o2,
                                           const pairs::MeshPair& pair, double scale, const Simplex& simplex,
                                           double rounding);

}  // namespace sdm::convex
