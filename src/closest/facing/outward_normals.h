// The normals by which faces of O1 choose faces of O2 that face the same way.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/surface.h>

#include <vector>

#include "geometry/triangle.h"
#include "geometry/vec.h"
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

}  // namespace sdm::facing
