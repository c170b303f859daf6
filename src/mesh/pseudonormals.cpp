#include "mesh/pseudonormals.h"

#include <utility>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 2048;

}  // namespace

Vec3 edge_pseudonormal(const Pseudonormals& normals, const Topology& topology, std::uint32_t edge) {
  Vec3 sum{};
  for (std::uint32_t f : topology.edge_faces(edge)) sum += normals.face[f];
  return sum;
}

Pseudonormals build_pseudonormals(FaceShapes faces, std::span<const Triangle> triangles,
                                  const VertexFaces& vertex_faces) {
  Pseudonormals n{std::move(faces.normal), std::vector<Vec3>(vertex_faces.size())};
  parallel_for(n.vertex.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (const std::uint32_t f : vertex_faces.of(v)) {
        const Triangle& t = triangles[f];
        n.vertex[v] += double{faces.angle[f][t[0] == v ? 0 : t[1] == v ? 1 : 2]} * n.face[f];
      }
  });
  return n;
}

}  // namespace sdm
