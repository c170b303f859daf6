#include "mesh/edit_topology.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "mesh/half_edges.h"

namespace sdm::mesh {
namespace {

constexpr std::size_t kEditGrain = 1 << 14;

// The vertices whose faces an edit changes, with what is built anew for each of them.
struct ChangedVertices {
  std::vector<std::uint32_t> vertices;     // in increasing order
  CompressedRows<std::uint32_t> faces;     // in increasing order
  CompressedRows<HalfEdge> half_edges;     // in the order of edges, those to larger vertices
  std::vector<std::uint32_t> edge_counts;  // of each vertex, to larger vertices

  [[nodiscard]] std::size_t place_of(std::uint32_t vertex) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(vertices, vertex) - vertices.begin());
  }
};

template <class Take>
void for_each_new_face(const TriangleEdit& edit, const Take& take) {
  for (const std::uint32_t f : edit.changed)
    if (!repeats_a_corner(edit.after[f])) take(f);
  for (auto f = static_cast<std::uint32_t>(edit.before.size()); f < edit.after.size(); ++f)
    if (!repeats_a_corner(edit.after[f])) take(f);
}

std::vector<std::uint32_t> changed_vertices(const TriangleEdit& edit) {
  std::vector<std::uint32_t> vertices;
  const auto add = [&](const Triangle& t) { vertices.insert(vertices.end(), t.begin(), t.end()); };
  for (const std::uint32_t f : edit.changed)
    if (!repeats_a_corner(edit.before[f])) add(edit.before[f]);
  for_each_new_face(edit, [&](std::uint32_t f) { add(edit.after[f]); });
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

ChangedVertices around_changes(const TriangleEdit& edit, const VertexFaces& before) {
  ChangedVertices result;
  result.vertices = changed_vertices(edit);
  std::vector<std::uint32_t> changed(edit.changed.begin(), edit.changed.end());
  std::ranges::sort(changed);
  result.faces = make_rows<std::uint32_t>(result.vertices.size(), [&](const auto& put) {
    for (std::size_t i = 0; i < result.vertices.size(); ++i)
      if (result.vertices[i] < before.size())
        for (const std::uint32_t f : before.of(result.vertices[i]))
          if (!std::ranges::binary_search(changed, f)) put(i, f);
    for_each_new_face(edit, [&](std::uint32_t f) {
      for (const std::uint32_t v : edit.after[f]) put(result.place_of(v), f);
    });
  });
  for (std::size_t i = 0; i < result.vertices.size(); ++i) std::ranges::sort(result.faces.of(i));
  result.half_edges = make_rows<HalfEdge>(result.vertices.size(), [&](const auto& put) {
    for (std::size_t i = 0; i < result.vertices.size(); ++i)
      for (const std::uint32_t f : result.faces.of(i))
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t a = edit.after[f][k], b = edit.after[f][(k + 1) % 3];
          if (std::min(a, b) == result.vertices[i])
            put(i, HalfEdge{std::max(a, b), edit.after[f][(k + 2) % 3], 3 * f + k});
        }
  });
  return result;
}

// Sorts the half-edges; false if some are of duplicate faces. All corners of an added face are changed
// vertices, its smallest one included.
bool sort_and_count(ChangedVertices& changed) {
  for (std::size_t i = 0; i < changed.vertices.size(); ++i) {
    const Share share = sort_half_edges(changed.half_edges.of(i));
    if (share.half_edges != changed.half_edges.of(i).size()) return false;
    changed.edge_counts.push_back(share.edges);
  }
  return true;
}

VertexFaces edited_faces(const VertexFaces& before, const ChangedVertices& changed, std::size_t count) {
  VertexFaces after;
  after.offsets.reserve(count + 1);
  after.items.reserve(before.items.size() + changed.faces.items.size());
  std::size_t next = 0;  // vertex
  const auto keep_until = [&](std::size_t end) {
    const std::size_t kept = std::min(end, before.size());
    if (next < kept) {
      const std::uint32_t first = before.offsets[next];
      const auto shift = static_cast<std::uint32_t>(after.items.size()) - first;  // modulo 2^32
      after.items.append(before.items.begin() + first, before.items.begin() + before.offsets[kept]);
      for (; next < kept; ++next) after.offsets.push_back(before.offsets[next] + shift);
    }
    for (; next < end; ++next) after.offsets.push_back(static_cast<std::uint32_t>(after.items.size()));
  };
  for (std::size_t i = 0; i < changed.vertices.size(); ++i) {
    keep_until(changed.vertices[i]);
    after.offsets.push_back(static_cast<std::uint32_t>(after.items.size()));
    const auto row = changed.faces.of(i);
    after.items.append(row.begin(), row.end());
    ++next;
  }
  keep_until(count);
  after.offsets.push_back(static_cast<std::uint32_t>(after.items.size()));
  return after;
}

// Edges in their new order. Those of changed vertices, the smaller ones of their ends, are built from
// half-edges; all others are copied, and `renumbered` maps their former numbers to the new ones.
class EdgeMerge {
 public:
  EdgeMerge(const Topology& before, const ChangedVertices& changed) : before_(before), changed_(changed) {
    after_.edges.reserve(before.edges.size() + changed.half_edges.items.size());
    after_.incident.offsets.reserve(after_.edges.capacity() + 1);
    after_.incident.items.reserve(before.incident.items.size() + changed.half_edges.items.size());
    renumbered_.resize(before.edges.size());
  }

  Topology run(Array<std::array<std::uint32_t, 3>> face_edges) && {
    std::size_t next = 0;  // edge before
    for (std::size_t i = 0; i < changed_.vertices.size(); ++i) {
      const std::uint32_t vertex = changed_.vertices[i];
      const std::size_t begin = first_edge(vertex, next), end = first_edge(vertex + 1, begin);
      keep(next, begin);
      new_edges_.push_back(static_cast<std::uint32_t>(after_.edges.size()));
      rebuild(i);
      next = end;
    }
    keep(next, before_.edges.size());
    after_.incident.offsets.push_back(static_cast<std::uint32_t>(after_.incident.items.size()));
    renumber(face_edges);
    return std::move(after_);
  }

 private:
  [[nodiscard]] std::size_t first_edge(std::uint32_t vertex, std::size_t from) const {
    const std::array<std::uint32_t, 2> first{vertex, 0};
    return static_cast<std::size_t>(
        std::lower_bound(before_.edges.begin() + static_cast<std::ptrdiff_t>(from), before_.edges.end(),
                         first) -
        before_.edges.begin());
  }

  void keep(std::size_t begin, std::size_t end) {
    if (begin == end) return;
    const std::uint32_t first = before_.incident.offsets[begin], last = before_.incident.offsets[end];
    const auto shift = static_cast<std::uint32_t>(after_.incident.items.size()) - first;  // modulo 2^32
    const auto place = static_cast<std::uint32_t>(after_.edges.size() - begin);           // likewise
    after_.edges.append(before_.edges.begin() + begin, before_.edges.begin() + end);
    after_.incident.items.append(before_.incident.items.begin() + first,
                                 before_.incident.items.begin() + last);
    for (std::size_t e = begin; e < end; ++e) {
      after_.incident.offsets.push_back(before_.incident.offsets[e] + shift);
      renumbered_[e] = static_cast<std::uint32_t>(e) + place;
    }
  }

  void rebuild(std::size_t i) {
    std::uint32_t larger = kNone;
    for (const HalfEdge& half_edge : changed_.half_edges.of(i)) {
      if (half_edge.larger != larger) {
        larger = half_edge.larger;
        after_.edges.push_back({changed_.vertices[i], larger});
        after_.incident.offsets.push_back(static_cast<std::uint32_t>(after_.incident.items.size()));
      }
      after_.incident.items.push_back(half_edge.corner / 3);
    }
  }

  void renumber(Array<std::array<std::uint32_t, 3>>& face_edges) {
    parallel_for(face_edges.size(), kEditGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        for (std::uint32_t& e : face_edges[f])
          if (e != kNone) e = renumbered_[e];
    });
    for (std::size_t i = 0; i < changed_.vertices.size(); ++i) {
      std::uint32_t edge = new_edges_[i] - 1, larger = kNone;  // modulo 2^32
      for (const HalfEdge& half_edge : changed_.half_edges.of(i)) {
        if (half_edge.larger != larger) {
          larger = half_edge.larger;
          ++edge;
        }
        face_edges[half_edge.corner / 3][half_edge.corner % 3] = edge;
      }
    }
    after_.face_edges = std::move(face_edges);
  }

  const Topology& before_;
  const ChangedVertices& changed_;
  Topology after_;
  std::vector<std::uint32_t> renumbered_, new_edges_;
};

}  // namespace

bool edit_topology(const TriangleEdit& edit, const TopologyBefore& before, Topology& topology,
                   VertexFaces& faces) {
  ChangedVertices changed = around_changes(edit, before.faces);
  if (!sort_and_count(changed)) return false;
  std::vector<std::array<std::uint32_t, 3>> face_edges;
  face_edges.reserve(edit.after.size());
  face_edges.assign(before.topology.face_edges.begin(), before.topology.face_edges.end());
  face_edges.resize(edit.after.size(), {kNone, kNone, kNone});
  std::size_t collapsed = before.topology.collapsed_faces;
  for (const std::uint32_t f : edit.changed) {
    face_edges[f] = {kNone, kNone, kNone};
    collapsed -= repeats_a_corner(edit.before[f]);
    collapsed += repeats_a_corner(edit.after[f]);
  }
  for (std::size_t f = edit.before.size(); f < edit.after.size(); ++f)
    collapsed += repeats_a_corner(edit.after[f]);
  topology = EdgeMerge(before.topology, changed).run(std::move(face_edges));
  topology.collapsed_faces = collapsed;
  faces = edited_faces(before.faces, changed, edit.vertex_count);
  return true;
}

}  // namespace sdm::mesh
