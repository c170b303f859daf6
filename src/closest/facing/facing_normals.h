// The normals by which the faces of O1 are matched.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/surface.h>

#include <cstdint>
#include <vector>

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::facing {

/// The unit normal of each face; 0 for faces without area. If the mesh is closed and orientable, they are
/// outward, as Sites orients O2, whichever way its faces are wound; otherwise by the order of their corners.
/// Cost: O(n log n), all cores.
[[nodiscard]] std::vector<Vec3> outward_normals(const Mesh& mesh);

/// The same, valid until the shape of the surface changes. Cost: that for the first call, then O(1).
[[nodiscard]] const std::vector<Vec3>& outward_normals(const Surface& surface);

/// Whether a mesh is closed and orientable, so that its outward normals do not depend on how faces are wound.
[[nodiscard]] bool has_outside(const Mesh& mesh);

/// The normal of a face of O2, as Sites orients it. Other than its pseudonormal, it follows from the corners
/// alone, also of slivers. Cost: O(1).
[[nodiscard]] inline Vec3 outward_normal(const sites::SitesData& sites, std::uint32_t face) {
  if (is_removed(sites.mesh.triangles[face])) return {};
  const auto [a, b, c] = corners_of(sites.mesh, face);
  const Vec3 normal = normalized(cross(b - a, c - a));
  return sites.inverted[face] != 0 ? -1.0 * normal : normal;
}

/// outward_normals(), but for faces whose direction is noise.
///
/// A face is *low* if its least height is below 1/1000 of the diagonal of the mesh's box. Its surroundings
/// are the other faces at its corners; their normal is the sum of their normals, weighted by area and by the
/// number of corners that they share. A low face takes the normal of its surroundings if that is not within
/// the angle of its own, if no more than half of their area cancels out in the sum, and if they have twice
/// its area or more, weighted alike. So a sliver that noise has turned over is measured as what is around it,
/// while rims of one row of faces, tips and small bodies keep their directions. Of a thin rim of several low
/// rows, those next to a large face take its normal. All points of such a face are within its height of its
/// surroundings, so that distances change by no more.
struct FacingNormals {
  std::vector<Vec3> normals;  ///< of all faces, unit length or 0
  /// The faces that have the normal of their surroundings, in their order.
  std::vector<std::uint32_t> replaced{};
  double height = 0;  ///< below which faces are low
};

/// `angle` as of check_angle(). Cost: that of outward_normals() and linear in the faces.
[[nodiscard]] FacingNormals facing_normals(const Mesh& mesh, double angle);

/// The same; further calls for the shape of the surface cost what is linear only.
[[nodiscard]] FacingNormals facing_normals(const Surface& surface, double angle);

}  // namespace sdm::facing
