#include "mesh/vertex_normals.h"

#include <sdm/mesh_edit.h>

#include <cmath>

#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm::mesh {

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (is_removed(mesh.triangles[f])) continue;
    const Corners c = corners_of(mesh, f);
    const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]), unit = normalized(normal);
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = c[(k + 1) % 3] - c[k], b = c[(k + 2) % 3] - c[k];
      normals[mesh.triangles[f][k]] += std::atan2(norm(normal), dot(a, b)) * unit;
    }
  }
  return normals;
}

}  // namespace sdm::mesh
