#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <new>

#include "core/cancellation.h"
#include "core/disjoint_sets.h"
#include "core/memory.h"
#include "mesh/topology.h"

namespace sdm {
namespace {

constexpr std::uint32_t kPolled = 4096;  // steps

void count_components(const Mesh& mesh, MeshInfo& info) {
  DisjointSets sets(mesh.positions.size());
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  Poll due(kPolled);
  for (const Triangle& t : mesh.triangles) {
    due();
    if (is_removed(t)) continue;
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

void count_nonmanifold_vertices(const Mesh& mesh, const mesh::Topology& topology, MeshInfo& info) {
  const mesh::VertexFaces rows = mesh::vertex_faces(mesh.positions.size(), mesh.triangles, topology);
  Poll due(kPolled);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    due();
    const std::span<const std::uint32_t> faces = rows.of(v);
    if (!faces.empty() && !mesh::is_fan(topology, v, faces)) ++info.nonmanifold_vertices;
  }
}

void measure(const Mesh& mesh, MeshInfo& info) {
  Poll due(kPolled);
  for (const Triangle& t : mesh.triangles) {
    due();
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 n = cross(b - a, c - a);
    info.degenerate_faces += n == Vec3{};
    info.area += 0.5 * norm(n);
  }
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
  measure(mesh, info);
  return info;
} catch (const std::bad_alloc&) {
  throw out_of_memory("mesh statistics");
}

}  // namespace sdm
