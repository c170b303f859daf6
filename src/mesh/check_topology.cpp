#include "mesh/check_topology.h"

#include <bit>

#include "core/arrays/check_rows.h"
#include "core/parallel_all.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kCheckGrain = 8192;

using Three = std::array<std::uint32_t, 3>;

// Two vertices as one number, which is faster to compare; with the first one as its lower half.
std::uint64_t number_of(std::uint32_t a, std::uint32_t b) {
  return a | std::uint64_t{b} << 32;
}
std::uint64_t number_of(const std::array<std::uint32_t, 2>& ends) {
  return number_of(ends[0], ends[1]);
}

// Whether edges run from the smaller vertex to the larger one, are in lexicographic order, and have faces.
bool are_in_order(const Topology& topology) {
  const std::span<const std::array<std::uint32_t, 2>> edges(topology.edges);
  const std::span<const std::uint32_t> offsets(topology.incident.offsets);
  std::uint64_t before = 0;  // smaller than all: the larger vertex of an edge is not 0
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint64_t number = std::rotl(number_of(edges[e]), 32);
    if (number <= before || edges[e][0] >= edges[e][1] || offsets[e] == offsets[e + 1]) return false;
    before = number;
  }
  return true;
}

// Whether each face has the edges between its corners, which differ as the ends of edges do, or none.
bool have_edges(const Topology& topology, std::span<const Triangle> triangles) {
  const std::span<const std::array<std::uint32_t, 2>> edges(topology.edges);
  const std::span<const Three> face_edges(topology.face_edges);
  return parallel_all(triangles.size(), kCheckGrain, [=](std::size_t begin, std::size_t end) {
    bool valid = true;
    for (std::size_t f = begin; f < end; ++f) {
      const Three& sides = face_edges[f];
      if (sides[0] == kNone) {
        if (sides[1] != kNone || sides[2] != kNone) return false;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        if (sides[k] >= edges.size()) return false;
        const std::uint64_t ends = number_of(edges[sides[k]]),
                            side = number_of(triangles[f][k], triangles[f][(k + 1) % 3]);
        valid &= (ends == side) | (ends == std::rotl(side, 32));
      }
    }
    return valid;
  });
}

// Whether row x has the faces of whose three x is one, ignored ones excluded.
bool are_faces_of(const CompressedRows<std::uint32_t>& rows, std::span<const Three> three,
                  const Topology& topology) {
  const std::span<const Three> face_edges(topology.face_edges);
  RowCheck check(rows);
  for (std::uint32_t f = 0; f < three.size(); ++f) {
    if (face_edges[f][0] == kNone) continue;
    for (const std::uint32_t x : three[f])
      if (!check.put(x, f)) return false;
  }
  return check.complete();
}

}  // namespace

bool is_topology(const Topology& topology, const VertexFaces& vertex_faces, const Mesh& mesh) {
  if (topology.face_edges.size() != mesh.triangles.size() ||
      topology.incident.offsets.size() != topology.edges.size() + 1 ||
      vertex_faces.offsets.size() != mesh.positions.size() + 1)
    return false;
  bool of_edges = false, of_vertices = false;
  parallel_invoke(
      [&] {
        of_edges = have_edges(topology, mesh.triangles) &&
                   are_faces_of(topology.incident, topology.face_edges, topology) && are_in_order(topology);
      },
      [&] { of_vertices = are_faces_of(vertex_faces, mesh.triangles, topology); });
  return of_edges && of_vertices;
}

bool are_flags(std::span<const std::uint8_t> flags) {
  std::uint8_t any = 0;
  for (const std::uint8_t flag : flags) any |= flag;
  return any <= 1;
}

bool is_orientation(const Orientation& orientation, const Topology& topology) {
  const std::span<const Three> face_edges(topology.face_edges);
  const std::span<const std::uint32_t> component(orientation.component), first_face(orientation.first_face);
  const std::size_t faces = face_edges.size();
  if (orientation.flipped.size() != faces || component.size() != faces || !are_flags(orientation.flipped))
    return false;
  for (std::size_t f = 0; f < faces; ++f) {
    const bool ignored = face_edges[f][0] == kNone;
    if (ignored ? component[f] != kNone : component[f] >= first_face.size()) return false;
  }
  for (std::size_t c = 0; c < first_face.size(); ++c)
    if (first_face[c] >= faces || component[first_face[c]] != c) return false;
  return true;
}

}  // namespace sdm::mesh
