#include "inside/open_sides.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <vector>

#include "core/arrays/rows.h"
#include "core/cancellation.h"
#include "geometry/predicates.h"
#include "geometry/vec.h"
#include "inside/face_sides.h"
#include "inside/near_faces.h"
#include "inside/solid.h"
#include "tree/visit.h"

namespace sdm::inside {

OpenSides::OpenSides(const sites::SitesData& sites, const OrientedFaces& closing)
    : sites_(sites),
      closing_(closing),
      boundary_(sites.topology, sites.mesh.positions.size()),
      offset_(offset_beside_faces(sites)),
      clearance_(kClearance / sites.frame.scale) {
  if (offset_ == 0 || !sites.orientation.orientable) return;
  outer_ = std::make_unique<std::atomic<std::int8_t>[]>(sites.mesh.triangles.size());
  for (std::size_t f = 0; f < sites.mesh.triangles.size(); ++f)
    outer_[f].store(kUnknown, std::memory_order_relaxed);
}

std::span<const std::uint32_t> OpenSides::faces_of(SiteType type, const std::uint32_t& site) const {
  if (type == SiteType::face) return {&site, 1};
  return type == SiteType::edge ? sites_.topology.edge_faces(site) : sites_.vertex_faces.of(site);
}

bool OpenSides::is_fan(SiteType type, std::uint32_t site) const {
  if (type == SiteType::face) return true;
  if (type == SiteType::edge) return sites_.topology.edge_faces(site).size() == 2;
  return mesh::is_fan(sites_.topology, site, sites_.vertex_faces.of(site));
}

// A face with an edge or a corner on the boundary is near to a closing face, unless that is somewhere else
// because the faces there are oriented against each other.
bool OpenSides::clear(std::uint32_t face) const {
  if (sites_.sliver[face] != 0 || sites_.topology.ignored(face)) return false;
  thread_local std::vector<std::uint32_t> near;
  find_near_faces(sites_, face, near);
  if (!near.empty()) return false;
  if (closing_.faces.tree.nodes.empty()) return true;
  Box box;
  for (const Vec3& corner : unit_corners(sites_, face)) extend(box, corner);
  const Vec3 margin{kClearance, kClearance, kClearance};
  const auto enlarged = tree::FloatBox::around({box.lower - margin, box.upper + margin});
  bool met = false;
  const auto enter = [&](tree::Subtree below) {
    return !met && gap(closing_.faces.tree.box(below.root), enlarged) == Vec3{};
  };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t other : closing_.faces.tree.items_of(leaf)) {
      Box of_other;
      for (const std::uint32_t v : closing_.faces.triangles[other])
        extend(of_other, sites_.frame.to_unit(sites_.mesh.positions[v]));
      met = met || gap(tree::FloatBox::around(of_other), enlarged) == Vec3{};
    }
  };
  visit(closing_.faces.tree, tree::InOrder{enter, visit_leaf});
  return !met;
}

std::int8_t OpenSides::known_to_neighbour(std::uint32_t face) const {
  for (const std::uint32_t edge : sites_.topology.face_edges[face]) {
    const std::span<const std::uint32_t> faces = sites_.topology.edge_faces(edge);
    if (faces.size() != 2) continue;
    const std::int8_t number = outer_[faces[faces[0] == face ? 1 : 0]].load(std::memory_order_relaxed);
    if (number <= kMost) return number;
  }
  return kUnknown;
}

Vec3 OpenSides::beside(std::uint32_t face) const {
  const auto& [a, b, c] = sites_.mesh.triangles[face];
  const std::vector<Vec3>& p = sites_.mesh.positions;
  return (1.0 / 3) * (p[a] + p[b] + p[c]) + offset_ * sites_.normals.face[face];
}

// Near a face, the side of its plane decides exactly, as for crossings: a point of the plane counts as below.
bool OpenSides::outside(const Vec3& q, const ClosestPoint& closest) const {
  if (closest.type != SiteType::face || closest.distance > clearance_)
    return dot(q - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest)) > 0;
  const auto& [a, b, c] = sites_.mesh.triangles[closest.face];
  const std::vector<Vec3>& p = sites_.mesh.positions;
  return (orientation(p[a], p[b], p[c], q) > 0) != (sites_.inverted[closest.face] != 0);
}

// The end lies in the ball around q that the mesh does not meet.
std::optional<int> OpenSides::crossings_of_closing(const Vec3& q, const ClosestPoint& closest) const {
  if (closing_.faces.tree.nodes.empty()) return 0;
  const Vec3 end = closest.point + offset_ / closest.distance * (q - closest.point);
  return crossings(closing_, {}, q, end);
}

namespace {

// An edge from the smaller to the larger vertex, and how often the faces pass it in this direction more than
// in the other.
struct NetEdge {
  std::array<std::uint32_t, 2> ends{};
  int passes = 0;
};

std::vector<NetEdge> net_edges(const sites::SitesData& sites) {
  const mesh::Topology& topology = sites.topology;
  std::vector<NetEdge> result;
  Poll due(1024);
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    due();
    int passes = 0;
    for (const std::uint32_t face : topology.edge_faces(e)) {
      const auto& edges = topology.face_edges[face];
      const int k = edges[0] == e ? 0 : edges[1] == e ? 1 : 2;
      passes += mesh::runs_forward(sites.mesh.triangles[face], k) != (sites.inverted[face] != 0) ? 1 : -1;
    }
    if (passes != 0) result.push_back({topology.edges[e], passes});
  }
  return result;
}

// Replaces vertices by the first one at the same position, and adds the passes of edges that become one:
// soups are closed where their triangles meet.
void join_vertices(const std::vector<Vec3>& positions, std::vector<NetEdge>& edges) {
  std::vector<std::uint32_t> vertices;
  for (const NetEdge& edge : edges) vertices.insert(vertices.end(), edge.ends.begin(), edge.ends.end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  std::vector<std::uint32_t> by_position = vertices, first(vertices.size());
  poll();
  std::ranges::stable_sort(by_position, {}, [&](std::uint32_t v) { return positions[v]; });
  const auto index_of = [&](std::uint32_t v) {
    return static_cast<std::size_t>(std::ranges::lower_bound(vertices, v) - vertices.begin());
  };
  for (std::size_t i = 0; i < by_position.size(); ++i)
    first[index_of(by_position[i])] = i > 0 && positions[by_position[i - 1]] == positions[by_position[i]]
                                          ? first[index_of(by_position[i - 1])]
                                          : by_position[i];
  for (NetEdge& edge : edges) {
    for (std::uint32_t& end : edge.ends) end = first[index_of(end)];
    if (edge.ends[0] > edge.ends[1]) {
      std::swap(edge.ends[0], edge.ends[1]);
      edge.passes *= -1;
    }
  }
  poll();
  std::ranges::sort(edges, {}, &NetEdge::ends);
  std::vector<NetEdge> joined;
  for (const NetEdge& edge : edges) {
    if (edge.ends[0] == edge.ends[1]) continue;
    if (!joined.empty() && joined.back().ends == edge.ends)
      joined.back().passes += edge.passes;
    else
      joined.push_back(edge);
  }
  std::erase_if(joined, [](const NetEdge& edge) { return edge.passes == 0; });
  edges = std::move(joined);
}

// Fills a loop, which the faces of the mesh run along, by halves: far from the loop its triangles are few,
// and small ones lie only where the boundary is uneven.
void fill(std::span<const std::uint32_t> loop, std::vector<Triangle>& faces) {
  if (loop.size() < 3) return;
  const std::size_t middle = loop.size() / 2;
  faces.push_back({loop.back(), loop[middle], loop.front()});
  fill(loop.first(middle + 1), faces);
  fill(loop.subspan(middle), faces);
}

}  // namespace

std::optional<std::vector<Triangle>> closing_faces(const sites::SitesData& sites, std::size_t most) {
  std::vector<NetEdge> edges = net_edges(sites);
  join_vertices(sites.mesh.positions, edges);
  // A loop of k edges takes k − 2 faces, and none has fewer than three.
  std::size_t boundary = 0;
  for (const NetEdge& edge : edges) boundary += static_cast<std::size_t>(std::abs(edge.passes));
  if (boundary > 3 * most) return {};
  const std::size_t vertices = sites.mesh.positions.size();
  // The ends of the edges that start at each vertex, as often as their passes.
  CompressedRows<std::uint32_t> next = make_rows<std::uint32_t>(vertices, [&](const auto& put) {
    for (const auto& [ends, passes] : edges)
      for (int i = 0; i < std::abs(passes); ++i) put(ends[passes > 0 ? 0 : 1], ends[passes > 0 ? 1 : 0]);
  });
  std::vector<std::uint32_t> left(vertices), place(vertices, kNone), path;
  for (std::size_t v = 0; v < vertices; ++v) left[v] = static_cast<std::uint32_t>(next.of(v).size());
  // As many edges end at a vertex as start there, so a walk along edges ends where it began. Each vertex that
  // it meets again closes a loop.
  std::vector<Triangle> faces;
  Poll due(1024);
  for (std::uint32_t start = 0; start < vertices; ++start)
    while (left[start] > 0) {
      for (std::uint32_t v = start; left[v] > 0 || place[v] != kNone; v = next.of(v)[--left[v]]) {
        due();
        if (place[v] != kNone) {
          const auto loop = std::span(path).subspan(place[v]);
          fill(loop, faces);
          for (const std::uint32_t w : loop) place[w] = kNone;
          path.resize(path.size() - loop.size());
          if (left[v] == 0) break;
        }
        place[v] = static_cast<std::uint32_t>(path.size());
        path.push_back(v);
      }
    }
  if (faces.size() > most) return {};
  return faces;
}

}  // namespace sdm::inside
