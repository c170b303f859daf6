#include "mesh/topology.h"

#include <algorithm>

namespace sdm {
namespace {

// Items sorted by a key below `bucket_count`, by counting: offsets of the buckets and the items in their
// order.
struct Buckets {
  std::vector<std::uint32_t> offsets, items;
};

template <typename Key>
Buckets bucket(std::size_t bucket_count, std::size_t item_count, const Key& key) {
  Buckets b{std::vector<std::uint32_t>(bucket_count + 1, 0), std::vector<std::uint32_t>(item_count)};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < item_count; ++i)
    if (const std::uint32_t k = key(i); k != kNone) ++b.offsets[k + 1], ++kept;
  for (std::size_t k = 0; k < bucket_count; ++k) b.offsets[k + 1] += b.offsets[k];
  std::vector<std::uint32_t> next(b.offsets.begin(), b.offsets.end() - 1);
  for (std::size_t i = 0; i < item_count; ++i)
    if (const std::uint32_t k = key(i); k != kNone) b.items[next[k]++] = static_cast<std::uint32_t>(i);
  b.items.resize(kept);
  return b;
}

// Which faces to leave out, as in Topology.
std::vector<std::uint8_t> find_ignored(std::size_t vertex_count, std::span<const Triangle> triangles,
                                       Topology& topology) {
  std::vector<std::uint8_t> ignored(triangles.size(), 0);
  std::vector<Triangle> sorted(triangles.begin(), triangles.end());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    std::sort(sorted[f].begin(), sorted[f].end());
    ignored[f] = sorted[f][0] == sorted[f][1] || sorted[f][1] == sorted[f][2];
    topology.collapsed_faces += ignored[f];
  }
  Buckets by_first = bucket(vertex_count, triangles.size(),
                            [&](std::size_t f) { return ignored[f] ? kNone : sorted[f][0]; });
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto begin = by_first.items.begin() + by_first.offsets[v];
    const auto end = by_first.items.begin() + by_first.offsets[v + 1];
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      return sorted[a] != sorted[b] ? sorted[a] < sorted[b] : a < b;
    });
    for (auto it = begin; it != end; ++it)
      if (it != begin && sorted[*it] == sorted[*(it - 1)]) ignored[*it] = 1, ++topology.duplicate_faces;
  }
  return ignored;
}

}  // namespace

Topology build_topology(std::size_t vertex_count, std::span<const Triangle> triangles) {
  Topology topology;
  topology.face_edges.assign(triangles.size(), {kNone, kNone, kNone});
  const std::vector<std::uint8_t> ignored = find_ignored(vertex_count, triangles, topology);

  // Corner 3f + k stands for the edge from corner k of face f to the next; gather corners by smaller vertex.
  const auto ends = [&](std::size_t corner) -> std::array<std::uint32_t, 2> {
    const Triangle& t = triangles[corner / 3];
    const std::uint32_t a = t[corner % 3], b = t[(corner + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
  };
  Buckets corners = bucket(vertex_count, 3 * triangles.size(),
                           [&](std::size_t corner) { return ignored[corner / 3] ? kNone : ends(corner)[0]; });
  topology.edges.reserve(corners.items.size() / 2 + 1);
  topology.incident.reserve(corners.items.size());
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto begin = corners.items.begin() + corners.offsets[v];
    const auto end = corners.items.begin() + corners.offsets[v + 1];
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t wa = ends(a)[1], wb = ends(b)[1];
      return wa != wb ? wa < wb : a < b;
    });
    for (auto it = begin; it != end; ++it) {
      if (it == begin || ends(*it)[1] != ends(*(it - 1))[1]) {
        topology.edge_offsets.push_back(static_cast<std::uint32_t>(topology.incident.size()));
        topology.edges.push_back(ends(*it));
      }
      topology.face_edges[*it / 3][*it % 3] = static_cast<std::uint32_t>(topology.edges.size() - 1);
      topology.incident.push_back(*it / 3);
    }
  }
  topology.edge_offsets.push_back(static_cast<std::uint32_t>(topology.incident.size()));
  return topology;
}

Orientation orient(std::span<const Triangle> triangles, const Topology& topology) {
  Orientation result;
  result.turned.assign(triangles.size(), 0);
  result.component.assign(triangles.size(), kNone);
  std::vector<std::uint32_t> stack;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (topology.ignored(seed) || result.component[seed] != kNone) continue;
    const auto component = static_cast<std::uint32_t>(result.components++);
    result.component[seed] = component;
    stack.push_back(static_cast<std::uint32_t>(seed));
    while (!stack.empty()) {
      const std::uint32_t f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t edge = topology.face_edges[f][k];
        const auto faces = topology.edge_faces(edge);
        if (faces.size() != 2) continue;
        const std::uint32_t g = faces[0] == f ? faces[1] : faces[0];
        const auto& edges = topology.face_edges[g];
        const int j = static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
        // Neighbours agree when they run along their edge in opposite directions.
        const bool same_way = runs_forward(triangles[f], k) == runs_forward(triangles[g], j);
        const std::uint8_t turned = result.turned[f] ^ static_cast<std::uint8_t>(same_way);
        if (result.component[g] == kNone) {
          result.component[g] = component;
          result.turned[g] = turned;
          stack.push_back(g);
        } else if (result.turned[g] != turned) {
          result.orientable = false;
        }
      }
    }
  }
  // Of two ways to agree, the one that turns fewer faces.
  std::vector<std::uint32_t> faces(result.components), turned(result.components);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    if (result.component[f] != kNone) {
      ++faces[result.component[f]];
      turned[result.component[f]] += result.turned[f];
    }
  for (std::size_t f = 0; f < triangles.size(); ++f)
    if (const std::uint32_t c = result.component[f]; c != kNone && turned[c] > faces[c] - turned[c])
      result.turned[f] ^= 1;
  return result;
}

VertexFaces vertex_faces(std::size_t vertex_count, std::span<const Triangle> triangles,
                         const Topology& topology) {
  Buckets b = bucket(vertex_count, 3 * triangles.size(), [&](std::size_t corner) {
    return topology.ignored(corner / 3) ? kNone : triangles[corner / 3][corner % 3];
  });
  for (std::uint32_t& item : b.items) item /= 3;
  return {std::move(b.offsets), std::move(b.items)};
}

}  // namespace sdm
