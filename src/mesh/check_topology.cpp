#include "mesh/check_topology.h"

#include <algorithm>
#include <vector>

#include "core/parallel_all.h"
#include "mesh/half_edges.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kCheckGrain = 8192;

// Whether valid(i) for all, in any order.
template <class Valid>
bool all_of(std::size_t count, const Valid& valid) {
  return parallel_all(count, kCheckGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!valid(i)) return false;
    return true;
  });
}

using Three = std::array<std::uint32_t, 3>;

// The ends of an edge as one number, which is faster to compare, in lexicographic order.
std::uint64_t number_of(const std::array<std::uint32_t, 2>& ends) {
  return std::uint64_t{ends[0]} << 32 | ends[1];
}

// Whether row x has the faces of whose three x is one, in increasing order, ignored ones excluded: the faces
// are put into the rows once more, and compared with what is there. No face has the same number twice.
bool are_faces_of(const CompressedRows<std::uint32_t>& rows, std::span<const Three> three,
                  const Topology& topology) {
  const std::span<const std::uint32_t> offsets(rows.offsets), items(rows.items);
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  std::uint32_t fault = 0;
  for (std::uint32_t f = 0; f < three.size(); ++f) {
    if (topology.ignored(f)) continue;
    for (const std::uint32_t x : three[f]) {
      const std::uint32_t at = next[x]++;
      if (at >= items.size()) return false;
      fault |= items[at] ^ f;
    }
  }
  for (std::size_t x = 0; x < next.size(); ++x) fault |= next[x] ^ offsets[x + 1];
  return fault == 0;
}

bool has_edges(const Triangle& t, std::size_t face, const Topology& topology) {
  const Three& edges = topology.face_edges[face];
  if (repeats_a_corner(t) || topology.ignored(face)) return edges == std::array{kNone, kNone, kNone};
  std::uint64_t fault = 0;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t edge = edges[k], a = t[k], b = t[(k + 1) % 3];
    if (edge >= topology.edges.size()) return false;
    fault |= number_of(topology.edges[edge]) ^ number_of({std::min(a, b), std::max(a, b)});
  }
  return fault == 0;
}

// Whether edges are in order, and have faces.
bool are_edges(const Topology& topology) {
  const std::span<const std::array<std::uint32_t, 2>> edges(topology.edges);
  const std::span<const std::uint32_t> offsets(topology.incident.offsets);
  bool valid = true;
  std::uint64_t before = 0;  // smaller than all: the larger vertex of an edge is not 0
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint64_t number = number_of(edges[e]);
    valid &= number > before;
    valid &= offsets[e] != offsets[e + 1];
    before = number;
  }
  return valid;
}

}  // namespace

bool are_rows(const CompressedRows<std::uint32_t>& rows, std::size_t count) {
  if (rows.offsets.size() != count + 1 || rows.offsets.front() != 0 ||
      rows.offsets.back() != rows.items.size())
    return false;
  return std::is_sorted(rows.offsets.begin(), rows.offsets.end());
}

bool is_topology(const Topology& topology, const VertexFaces& vertex_faces, const Mesh& mesh) {
  const std::size_t faces = mesh.triangles.size(), edges = topology.edges.size();
  if (topology.face_edges.size() != faces || !are_rows(topology.incident, edges) ||
      !are_rows(vertex_faces, mesh.positions.size()))
    return false;
  if (!all_of(faces, [&](std::size_t f) { return has_edges(mesh.triangles[f], f, topology); }) ||
      !are_edges(topology))
    return false;
  bool of_edges = false, of_vertices = false;
  parallel_invoke([&] { of_edges = are_faces_of(topology.incident, topology.face_edges, topology); },
                  [&] { of_vertices = are_faces_of(vertex_faces, mesh.triangles, topology); });
  return of_edges && of_vertices;
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
