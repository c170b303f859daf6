// The winding number of closed meshes, decided exactly.
#pragma once

#include <optional>

#include "geometry/affine.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// The winding number of a closed mesh moved by `pose`, with outward-oriented faces, around p, from the
/// crossings of the segment to a point q outside the mesh. Empty if the segment intersects an edge. Exact if
/// p does not lie on the surface. Cost: O(log n), plus linear in the faces that the segment meets.
[[nodiscard]] std::optional<int> winding(const sites::SitesData& sites, const Affine& pose, const Vec3& p,
                                         const Vec3& q);

/// The winding number of a solid moved by `pose` around a point that does not lie on its surface: 0 outside.
/// Exact; 0 for a point on an edge. Cost: usually one call of the above.
[[nodiscard]] int winding(const sites::SitesData& solid, const Affine& pose, const Vec3& point);

/// Whether a solid moved by `pose` contains a point that does not lie on its surface: whether its winding
/// number around the point is not 0.
[[nodiscard]] inline bool contains(const sites::SitesData& solid, const Affine& pose, const Vec3& point) {
  return winding(solid, pose, point) != 0;
}

}  // namespace sdm::inside
