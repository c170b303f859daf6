#include "sites/pseudonormals.h"

namespace sdm::sites {

Vec3 pseudonormal(const Pseudonormals& normals, const mesh::Topology& topology, const ClosestPoint& closest) {
  if (closest.type == SiteType::vertex) return normals.vertex[closest.site];
  if (closest.type != SiteType::edge) return normals.face[closest.face];
  Vec3 sum{};
  for (const std::uint32_t f : topology.edge_faces(closest.site)) sum += normals.face[f];
  return sum;
}

}  // namespace sdm::sites
