#include "mesh/check_topology.h"

#include <algorithm>
#include <atomic>

#include "core/parallel.h"
#include "mesh/half_edges.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kCheckGrain = 8192;

// Whether valid(i) for all, in any order.
template <class Valid>
bool all_of(std::size_t count, const Valid& valid) {
  std::atomic<bool> all{true};
  parallel_for(count, kCheckGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!valid(i)) {
        all.store(false, std::memory_order_relaxed);
        return;
      }
  });
  return all;
}

// Whether the items of a row increase and are faces that are not ignored.
bool are_faces(std::span<const std::uint32_t> row, const Topology& topology) {
  for (std::size_t i = 0; i < row.size(); ++i)
    if (row[i] >= topology.face_edges.size() || topology.ignored(row[i]) || (i > 0 && row[i] <= row[i - 1]))
      return false;
  return true;
}

bool has_edges(const Triangle& t, std::size_t face, const Topology& topology) {
  if (repeats_a_corner(t) || topology.ignored(face))
    return topology.face_edges[face] == std::array{kNone, kNone, kNone};
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t edge = topology.face_edges[face][k], a = t[k], b = t[(k + 1) % 3];
    if (edge >= topology.edges.size()) return false;
    if (topology.edges[edge] != std::array{std::min(a, b), std::max(a, b)}) return false;
  }
  return true;
}

}  // namespace

bool are_rows(const CompressedRows<std::uint32_t>& rows, std::size_t count) {
  if (rows.offsets.size() != count + 1 || rows.offsets.front() != 0 ||
      rows.offsets.back() != rows.items.size())
    return false;
  return std::is_sorted(rows.offsets.begin(), rows.offsets.end());
}

// Every item of a row belongs there, and none occurs twice in it: as there are as many as all faces have
// sides or corners, none is missing.
bool is_topology(const Topology& topology, const VertexFaces& vertex_faces, const Mesh& mesh) {
  const std::size_t faces = mesh.triangles.size(), vertices = mesh.positions.size();
  if (topology.face_edges.size() != faces || !are_rows(topology.incident, topology.edges.size()) ||
      !are_rows(vertex_faces, vertices))
    return false;
  if (!all_of(faces, [&](std::size_t f) { return has_edges(mesh.triangles[f], f, topology); })) return false;
  std::size_t used = 0;
  for (std::size_t f = 0; f < faces; ++f) used += topology.ignored(f) ? 0 : 1;
  if (topology.incident.items.size() != 3 * used || vertex_faces.items.size() != 3 * used) return false;
  return all_of(topology.edges.size(),
                [&](std::size_t e) {
                  if (e > 0 && topology.edges[e] <= topology.edges[e - 1]) return false;
                  const auto row = topology.edge_faces(e);
                  return !row.empty() && are_faces(row, topology) &&
                         std::ranges::all_of(row, [&](std::uint32_t f) {
                           return std::ranges::find(topology.face_edges[f], e) !=
                                  topology.face_edges[f].end();
                         });
                }) &&
         all_of(vertices, [&](std::size_t v) {
           const auto row = vertex_faces.of(v);
           return are_faces(row, topology) && std::ranges::all_of(row, [&](std::uint32_t f) {
                    return std::ranges::find(mesh.triangles[f], v) != mesh.triangles[f].end();
                  });
         });
}

bool is_orientation(const Orientation& orientation, const Topology& topology) {
  const std::size_t faces = topology.face_edges.size(), components = orientation.first_face.size();
  if (orientation.flipped.size() != faces || orientation.component.size() != faces) return false;
  for (std::size_t f = 0; f < faces; ++f) {
    const std::uint32_t component = orientation.component[f];
    if (orientation.flipped[f] > 1) return false;
    if (topology.ignored(f) ? component != kNone : component >= components) return false;
  }
  for (std::size_t c = 0; c < components; ++c) {
    const std::uint32_t first = orientation.first_face[c];
    if (first >= faces || orientation.component[first] != c) return false;
  }
  return true;
}

}  // namespace sdm::mesh
