#include "query/pairs/mesh_pair.h"

namespace sdm::pairs {

Corners MeshPair::face1(std::uint32_t face) const {
  const auto& [a, b, c] = o1.mesh.triangles[face];
  const auto& at = o1.mesh.positions;
  return {at[a], at[b], at[c]};
}

Corners MeshPair::face2(std::uint32_t face) const {
  const auto& [a, b, c] = o2.mesh.triangles[face];
  const auto& at = o2.mesh.positions;
  return {pose(at[a]), pose(at[b]), pose(at[c])};
}

}  // namespace sdm::pairs
