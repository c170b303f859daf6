#include "mesh/pseudonormals.h"

#include <algorithm>
#include <numbers>

#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/solid_angle.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 1024;

double angle_at(const Vec3& corner, const Vec3& p, const Vec3& q) {
  const Vec3 u = p - corner, v = q - corner;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

bool encloses(const Box& outer, const Box& inner) {
  for (int k = 0; k < 3; ++k)
    if (!(outer.lo[k] <= inner.lo[k] && inner.hi[k] <= outer.hi[k])) return false;
  return true;
}

// One component of faces, all turned alike.
struct Shell {
  std::vector<std::uint32_t> faces;
  Box box;
};

// Full turns of the shell's faces around q: ±1 inside, 0 outside.
double winding(const Shell& shell, const Vec3& q, std::span<const Vec3> p,
               std::span<const Triangle> triangles, std::span<const std::uint8_t> turned) {
  double sum = 0;
  for (std::uint32_t f : shell.faces) {
    const Triangle& t = triangles[f];
    const double angle = solid_angle(p[t[0]] - q, p[t[1]] - q, p[t[2]] - q);
    sum += turned[f] ? -angle : angle;
  }
  return sum / (4 * std::numbers::pi);
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

std::vector<std::uint8_t> find_inverted(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                        const Orientation& orientation) {
  std::vector<Shell> shells(orientation.components);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (orientation.component[f] == kNone) continue;
    Shell& shell = shells[orientation.component[f]];
    shell.faces.push_back(static_cast<std::uint32_t>(f));
    for (std::uint32_t v : triangles[f]) extend(shell.box, positions[v]);
  }
  std::vector<std::uint8_t> inverted = orientation.turned;
  parallel_for(shells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec3& corner = positions[triangles[shells[s].faces[0]][0]];
      double volume = 0;  // six times; the corner as origin keeps digits for shells far from the mesh's
      for (std::uint32_t f : shells[s].faces) {
        const Triangle& t = triangles[f];
        const double v =
            dot(positions[t[0]] - corner, cross(positions[t[1]] - corner, positions[t[2]] - corner));
        volume += orientation.turned[f] ? -v : v;
      }
      int depth = 0;
      for (std::size_t o = 0; o < shells.size(); ++o)
        if (o != s && encloses(shells[o].box, shells[s].box))
          depth += std::abs(winding(shells[o], corner, positions, triangles, orientation.turned)) > 0.5;
      if ((volume < 0) != (depth % 2 == 1))
        for (std::uint32_t f : shells[s].faces) inverted[f] ^= 1;
    }
  });
  return inverted;
}

}  // namespace sdm
