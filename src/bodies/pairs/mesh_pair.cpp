#include "bodies/pairs/mesh_pair.h"

namespace sdm::pairs {

Vec3 MeshPair::point2(std::uint32_t vertex) const {
  return pose(o2.mesh.positions[vertex]);
}

Corners MeshPair::face1(std::uint32_t face) const {
  return corners_of(o1.mesh, face);
}

Corners MeshPair::face2(std::uint32_t face) const {
  const auto& [a, b, c] = o2.mesh.triangles[face];
  const std::vector<Vec3>& at = o2.mesh.positions;  // not copied before they are posed
  return {pose(at[a]), pose(at[b]), pose(at[c])};
}

}  // namespace sdm::pairs
