#include "sites/pseudonormals.h"

#include "core/vec.h"

namespace sdm::sites {

Vec3 edge_pseudonormal(const Pseudonormals& normals, const mesh::Topology& topology, std::uint32_t edge) {
  Vec3 sum{};
  for (std::uint32_t f : topology.edge_faces(edge)) sum += normals.face[f];
  return sum;
}

}  // namespace sdm::sites
