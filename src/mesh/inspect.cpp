#include <sdm/mesh.h>

#include <algorithm>
#include <new>

#include "core/disjoint_sets.h"
#include "core/geometry/vec.h"
#include "core/memory.h"
#include "mesh/topology.h"

namespace sdm {
namespace {

void count_components(const Mesh& mesh, MeshInfo& info) {
  DisjointSets sets(mesh.positions.size());
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = 1;
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v])
      ++info.unused_vertices;
    else if (sets.find(v) == v)
      ++info.components;
  }
}

// Walks from face to face around a vertex, from `face` across its edge `edge`, until it reaches a boundary
// edge or `face` again; returns the number of faces entered. Requires that no edge at the vertex has more
// than two faces.
std::size_t walk(const mesh::Topology& topology, std::uint32_t vertex, std::uint32_t face,
                 std::uint32_t edge) {
  std::size_t entered = 0;
  for (std::uint32_t f = face;;) {
    const auto faces = topology.edge_faces(edge);
    if (faces.size() < 2) return entered;
    f = faces[0] == f ? faces[1] : faces[0];
    if (f == face) return entered;
    ++entered;
    const auto& edges = topology.face_edges[f];
    edge = *std::find_if(edges.begin(), edges.end(), [&](std::uint32_t e) {
      return e != edge && (topology.edges[e][0] == vertex || topology.edges[e][1] == vertex);
    });
  }
}

// Whether the faces of a vertex form one fan, open or closed: each edge at the vertex has at most two of
// them, and a walk from any of them across both of its edges reaches them all.
bool is_fan(const mesh::Topology& topology, std::uint32_t vertex, std::span<const std::uint32_t> faces) {
  std::array<std::uint32_t, 2> first_edges{};
  for (const std::uint32_t f : faces) {
    int k = 0;
    for (const std::uint32_t e : topology.face_edges[f]) {
      if (topology.edges[e][0] != vertex && topology.edges[e][1] != vertex) continue;
      if (topology.edge_faces(e).size() > 2) return false;
      if (f == faces[0]) first_edges[k++] = e;
    }
  }
  const std::size_t ahead = walk(topology, vertex, faces[0], first_edges[0]);
  if (ahead + 1 == faces.size()) return true;
  return ahead + 1 + walk(topology, vertex, faces[0], first_edges[1]) == faces.size();
}

void count_nonmanifold_vertices(const Mesh& mesh, const mesh::Topology& topology, MeshInfo& info) {
  const mesh::VertexFaces rows = mesh::vertex_faces(mesh.positions.size(), mesh.triangles, topology);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const std::span<const std::uint32_t> faces = rows.of(v);
    if (!faces.empty() && !is_fan(topology, v, faces)) ++info.nonmanifold_vertices;
  }
}

// Measures the area and, for a closed mesh, the volume: by Gauss's theorem, the sum of the signed tetrahedra
// with the centre of the bounds as apex.
void measure(const Mesh& mesh, const mesh::Topology& topology, const mesh::Orientation& orientation,
             MeshInfo& info) {
  const Vec3 origin = info.bounds.lo[0] <= info.bounds.hi[0] ? centre(info.bounds) : Vec3{};
  double six_volumes = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin,
               c = mesh.positions[t[2]] - origin;
    const Vec3 n = cross(b - a, c - a);
    info.degenerate_faces += n == Vec3{};
    info.area += 0.5 * norm(n);
    if (!topology.ignored(f)) six_volumes += (orientation.flipped[f] ? -1 : 1) * dot(a, n);
  }
  if (info.closed && info.orientable) info.volume = std::abs(six_volumes) / 6;
}

}  // namespace

MeshInfo inspect(const Mesh& mesh) try {
  MeshInfo info;
  info.vertices = mesh.positions.size();
  info.triangles = mesh.triangles.size();
  info.bounds = bounds(mesh);
  info.has_uvs = !mesh.corner_uvs.empty();

  const mesh::Topology topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
  info.edges = topology.edges.size();
  info.duplicate_faces = topology.duplicate_faces;
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    info.boundary_edges += topology.edge_faces(e).size() == 1;
    info.nonmanifold_edges += topology.edge_faces(e).size() > 2;
  }
  info.closed = info.edges > 0 && info.boundary_edges == 0 && info.nonmanifold_edges == 0;

  const mesh::Orientation orientation = orient(mesh.triangles, topology);
  info.orientable = orientation.orientable;
  info.oriented =
      orientation.orientable &&
      std::all_of(orientation.flipped.begin(), orientation.flipped.end(), [](auto t) { return t == 0; });

  count_components(mesh, info);
  count_nonmanifold_vertices(mesh, topology, info);
  info.manifold = info.nonmanifold_edges == 0 && info.nonmanifold_vertices == 0;
  measure(mesh, topology, orientation, info);
  return info;
} catch (const std::bad_alloc&) {
  throw out_of_memory("mesh statistics");
}

}  // namespace sdm
