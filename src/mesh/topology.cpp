#include "mesh/topology.h"

#include <algorithm>
#include <numeric>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "mesh/half_edges.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kBuildGrain = 4096;

CompressedRows<HalfEdge> half_edges_by_smaller_vertex(std::size_t vertex_count,
                                                      std::span<const Triangle> triangles) {
  return make_rows<HalfEdge>(vertex_count, [&](const auto& put) {
    Poll due(kBuildGrain);
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
      due();
      const auto [a, b, c] = triangles[f];
      if (repeats_a_corner(triangles[f])) continue;
      put(std::min(a, b), HalfEdge{std::max(a, b), c, 3 * f});
      put(std::min(b, c), HalfEdge{std::max(b, c), a, 3 * f + 1});
      put(std::min(c, a), HalfEdge{std::max(c, a), b, 3 * f + 2});
    }
  });
}

// Has for each half-edge of a face twice the neighbouring face, plus 1 if both traverse the edge in the same
// direction; kNone unless there is exactly one neighbour.
using Neighbours = std::array<std::uint32_t, 3>;

std::vector<Neighbours> find_neighbours(std::span<const Triangle> triangles, const Topology& topology) {
  std::vector<Neighbours> neighbours(triangles.size(), {kNone, kNone, kNone});
  parallel_for(topology.edges.size(), kBuildGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto faces = topology.edge_faces(e);
      if (faces.size() != 2) continue;
      std::uint32_t *across[2], same_way = 1;
      for (int i = 0; i < 2; ++i) {
        const auto& edges = topology.face_edges[faces[i]];
        const int k = edges[0] == e ? 0 : edges[1] == e ? 1 : 2;
        across[i] = &neighbours[faces[i]][k];
        same_way ^= runs_forward(triangles[faces[i]], k);
      }
      *across[0] = 2 * faces[1] + same_way;
      *across[1] = 2 * faces[0] + same_way;
    }
  });
  return neighbours;
}

// Walks from face to face around a vertex, from `face` across its edge `edge`, until it reaches a boundary
// edge or `face` again; returns the number of faces entered. Requires that no edge at the vertex has more
// than two faces.
std::size_t walk(const Topology& topology, std::uint32_t vertex, std::uint32_t face, std::uint32_t edge) {
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

}  // namespace

Share sort_half_edges(std::span<HalfEdge> half_edges) {
  std::ranges::sort(half_edges, [](const HalfEdge& a, const HalfEdge& b) {
    if (a.larger != b.larger) return a.larger < b.larger;
    return a.opposite != b.opposite ? a.opposite < b.opposite : a.corner < b.corner;
  });
  const auto end = std::unique(
      half_edges.begin(), half_edges.end(),
      [](const HalfEdge& a, const HalfEdge& b) { return a.larger == b.larger && a.opposite == b.opposite; });
  Share share{0, static_cast<std::uint32_t>(end - half_edges.begin())};
  for (auto begin = half_edges.begin(); begin != end; ++share.edges) {
    const auto next = std::find_if(begin, end, [&](const HalfEdge& s) { return s.larger != begin->larger; });
    std::sort(begin, next, [](const HalfEdge& a, const HalfEdge& b) { return a.corner < b.corner; });
    begin = next;
  }
  return share;
}

bool Topology::closed() const {
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edge_faces(e).size() != 2) return false;
  return true;
}

Topology build_topology(std::size_t vertex_count, std::span<const Triangle> triangles) {
  CompressedRows<HalfEdge> half_edges = half_edges_by_smaller_vertex(vertex_count, triangles);
  std::vector<Share> first(vertex_count + 1);  // of each vertex, once summed
  parallel_for(vertex_count, kBuildGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) first[v + 1] = sort_half_edges(half_edges.of(v));
  });
  std::partial_sum(first.begin(), first.end(), first.begin());

  Topology topology;
  topology.face_edges.assign(triangles.size(), {kNone, kNone, kNone});
  topology.edges.resize(first.back().edges);
  topology.incident.offsets.resize(first.back().edges + 1);
  topology.incident.items.resize(first.back().half_edges);
  topology.incident.offsets.back() = first.back().half_edges;
  topology.collapsed_faces = triangles.size() - half_edges.items.size() / 3;
  topology.duplicate_faces = (half_edges.items.size() - topology.incident.items.size()) / 3;
  parallel_for(vertex_count, kBuildGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      auto [edges, incident] = first[v];
      std::uint32_t larger = kNone;
      for (const HalfEdge& half_edge : half_edges.of(v).first(first[v + 1].half_edges - incident)) {
        if (half_edge.larger != larger) {
          larger = half_edge.larger;
          topology.edges[edges] = {static_cast<std::uint32_t>(v), larger};
          topology.incident.offsets[edges++] = incident;
        }
        topology.face_edges[half_edge.corner / 3][half_edge.corner % 3] = edges - 1;
        topology.incident.items[incident++] = half_edge.corner / 3;
      }
    }
  });
  return topology;
}

Orientation orient(std::span<const Triangle> triangles, const Topology& topology) {
  const std::vector<Neighbours> neighbours = find_neighbours(triangles, topology);
  Orientation result;
  result.flipped.assign(triangles.size(), 0);
  result.component.assign(triangles.size(), kNone);
  std::vector<std::uint32_t> members;  // of a component, in the order of their discovery
  Poll due(kBuildGrain);
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (topology.ignored(seed) || result.component[seed] != kNone) continue;
    const auto component = static_cast<std::uint32_t>(result.first_face.size());
    result.first_face.push_back(static_cast<std::uint32_t>(seed));
    result.component[seed] = component;
    members.assign(1, static_cast<std::uint32_t>(seed));
    std::size_t flipped_members = 0;
    for (std::size_t next = 0; next < members.size(); ++next) {
      due();
      const std::uint32_t f = members[next];
      flipped_members += result.flipped[f];
      for (const std::uint32_t neighbour : neighbours[f]) {
        if (neighbour == kNone) continue;
        // Neighbours agree if they traverse their edge in opposite directions.
        const std::uint32_t g = neighbour / 2;
        const auto flipped = static_cast<std::uint8_t>(result.flipped[f] ^ (neighbour & 1));
        if (result.component[g] == kNone) {
          result.component[g] = component;
          result.flipped[g] = flipped;
          members.push_back(g);
        } else if (result.flipped[g] != flipped) {
          result.orientable = false;
        }
      }
    }
    // Takes the one of the two consistent orientations that flips fewer faces.
    if (flipped_members > members.size() - flipped_members)
      for (const std::uint32_t f : members) result.flipped[f] ^= 1;
  }
  return result;
}

VertexFaces vertex_faces(std::size_t vertex_count, std::span<const Triangle> triangles,
                         const Topology& topology) {
  return make_rows<std::uint32_t>(vertex_count, [&](const auto& put) {
    Poll due(kBuildGrain);
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
      due();
      if (!topology.ignored(f))
        for (const std::uint32_t v : triangles[f]) put(v, f);
    }
  });
}

bool is_fan(const Topology& topology, std::uint32_t vertex, std::span<const std::uint32_t> faces) {
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

}  // namespace sdm::mesh
