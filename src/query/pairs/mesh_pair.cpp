#include "query/pairs/mesh_pair.h"

namespace sdm::pairs {

Corners MeshPair::face1(std::uint32_t face) const {
  return corners_of(o1.mesh, face);
}

Corners MeshPair::face2(std::uint32_t face) const {
  const auto [a, b, c] = corners_of(o2.mesh, face);
  return {pose(a), pose(b), pose(c)};
}

}  // namespace sdm::pairs
