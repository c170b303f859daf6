#include "mesh/pseudonormals.h"

#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 1024;

double angle_at(const Vec3& corner, const Vec3& p, const Vec3& q) {
  const Vec3 u = p - corner, v = q - corner;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

}  // namespace

Vec3 edge_pseudonormal(const Pseudonormals& normals, const Topology& topology, std::uint32_t edge) {
  Vec3 sum{};
  for (std::uint32_t f : topology.edge_faces(edge)) sum += normals.face[f];
  return sum;
}

Pseudonormals build_pseudonormals(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                  const VertexFaces& incidence, std::span<const std::uint8_t> inverted) {
  Pseudonormals n{std::vector<Vec3>(triangles.size()), std::vector<Vec3>(positions.size())};
  parallel_for(triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle& t = triangles[f];
      const Vec3& a = positions[t[0]];
      const Vec3 normal = normalized(cross(positions[t[1]] - a, positions[t[2]] - a));
      n.face[f] = inverted[f] ? -normal : normal;
    }
  });
  parallel_for(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (std::uint32_t i = incidence.offsets[v]; i < incidence.offsets[v + 1]; ++i) {
        const std::uint32_t f = incidence.faces[i];
        const Triangle& t = triangles[f];
        const int k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        const double angle = angle_at(positions[v], positions[t[(k + 1) % 3]], positions[t[(k + 2) % 3]]);
        n.vertex[v] += angle * n.face[f];
      }
  });
  return n;
}

}  // namespace sdm
