#include "mesh/topology.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kGrain = 4096;

// A side of a face, in the list of the smaller vertex of its edge.
struct Side {
  std::uint32_t larger, opposite;
  std::uint32_t corner;  ///< 3f + k for the side from corner k of face f to the next
};

// The contribution of one vertex to the arrays of a topology.
struct Share {
  std::uint32_t edges = 0, sides = 0;

  friend Share operator+(const Share& a, const Share& b) { return {a.edges + b.edges, a.sides + b.sides}; }
};

bool repeats_a_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

CompressedRows<Side> sides_by_smaller_vertex(std::size_t vertex_count, std::span<const Triangle> triangles) {
  return make_rows<Side>(vertex_count, [&](const auto& put) {
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
      const auto [a, b, c] = triangles[f];
      if (repeats_a_corner(triangles[f])) continue;
      put(std::min(a, b), Side{std::max(a, b), c, 3 * f});
      put(std::min(b, c), Side{std::max(b, c), a, 3 * f + 1});
      put(std::min(c, a), Side{std::max(c, a), b, 3 * f + 2});
    }
  });
}

// Brings the sides of a vertex into the order of edges and faces. Those of duplicate faces, which a side of
// an earlier face resembles in all three vertices, move to the end and are not counted.
Share sort_sides(std::span<Side> sides) {
  std::ranges::sort(sides, [](const Side& a, const Side& b) {
    if (a.larger != b.larger) return a.larger < b.larger;
    return a.opposite != b.opposite ? a.opposite < b.opposite : a.corner < b.corner;
  });
  const auto end = std::unique(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.larger == b.larger && a.opposite == b.opposite;
  });
  Share share{0, static_cast<std::uint32_t>(end - sides.begin())};
  for (auto begin = sides.begin(); begin != end; ++share.edges) {
    const auto next = std::find_if(begin, end, [&](const Side& s) { return s.larger != begin->larger; });
    std::sort(begin, next, [](const Side& a, const Side& b) { return a.corner < b.corner; });
    begin = next;
  }
  return share;
}

// Across each side of each face: twice the neighbour, plus 1 if the two run along their edge the same way;
// kNone unless there is exactly one.
using Neighbours = std::array<std::uint32_t, 3>;

std::vector<Neighbours> find_neighbours(std::span<const Triangle> triangles, const Topology& topology) {
  std::vector<Neighbours> neighbours(triangles.size(), {kNone, kNone, kNone});
  parallel_for(topology.edges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
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

}  // namespace

bool Topology::closed() const {
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edge_faces(e).size() != 2) return false;
  return true;
}

Topology build_topology(std::size_t vertex_count, std::span<const Triangle> triangles) {
  CompressedRows<Side> sides = sides_by_smaller_vertex(vertex_count, triangles);
  std::vector<Share> first(vertex_count + 1);  // of each vertex, once summed
  parallel_for(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) first[v + 1] = sort_sides(sides.of(v));
  });
  std::partial_sum(first.begin(), first.end(), first.begin());

  Topology topology;
  topology.face_edges.assign(triangles.size(), {kNone, kNone, kNone});
  topology.edges.resize(first.back().edges);
  topology.incident.offsets.resize(first.back().edges + 1);
  topology.incident.items.resize(first.back().sides);
  topology.incident.offsets.back() = first.back().sides;
  topology.collapsed_faces = triangles.size() - sides.items.size() / 3;
  topology.duplicate_faces = (sides.items.size() - topology.incident.items.size()) / 3;
  parallel_for(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      auto [edges, incident] = first[v];
      std::uint32_t larger = kNone;
      for (const Side& side : sides.of(v).first(first[v + 1].sides - incident)) {
        if (side.larger != larger) {
          larger = side.larger;
          topology.edges[edges] = {static_cast<std::uint32_t>(v), larger};
          topology.incident.offsets[edges++] = incident;
        }
        topology.face_edges[side.corner / 3][side.corner % 3] = edges - 1;
        topology.incident.items[incident++] = side.corner / 3;
      }
    }
  });
  return topology;
}

Orientation orient(std::span<const Triangle> triangles, const Topology& topology) {
  const std::vector<Neighbours> neighbours = find_neighbours(triangles, topology);
  Orientation result;
  result.turned.assign(triangles.size(), 0);
  result.component.assign(triangles.size(), kNone);
  std::vector<std::uint32_t> members;  // of a component, in the order of their discovery
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (topology.ignored(seed) || result.component[seed] != kNone) continue;
    const auto component = static_cast<std::uint32_t>(result.first_face.size());
    result.first_face.push_back(static_cast<std::uint32_t>(seed));
    result.component[seed] = component;
    members.assign(1, static_cast<std::uint32_t>(seed));
    std::size_t turned_members = 0;
    for (std::size_t next = 0; next < members.size(); ++next) {
      const std::uint32_t f = members[next];
      turned_members += result.turned[f];
      for (const std::uint32_t neighbour : neighbours[f]) {
        if (neighbour == kNone) continue;
        // Neighbours agree when they run along their edge in opposite directions.
        const std::uint32_t g = neighbour / 2;
        const auto turned = static_cast<std::uint8_t>(result.turned[f] ^ (neighbour & 1));
        if (result.component[g] == kNone) {
          result.component[g] = component;
          result.turned[g] = turned;
          members.push_back(g);
        } else if (result.turned[g] != turned) {
          result.orientable = false;
        }
      }
    }
    // Of the two consistent orientations, the one that flips fewer faces.
    if (turned_members > members.size() - turned_members)
      for (const std::uint32_t f : members) result.turned[f] ^= 1;
  }
  return result;
}

VertexFaces vertex_faces(std::size_t vertex_count, std::span<const Triangle> triangles,
                         const Topology& topology) {
  return make_rows<std::uint32_t>(vertex_count, [&](const auto& put) {
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
      if (!topology.ignored(f))
        for (const std::uint32_t v : triangles[f]) put(v, f);
  });
}

}  // namespace sdm::mesh
