#include "sites/check_regions.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "mesh/check_topology.h"
#include "tree/fold.h"

namespace sdm::sites {
namespace {

bool has_sizes(const SitesData& s) {
  const Regions& r = s.regions;
  const std::size_t faces = s.tree.items.size(), edges = s.topology.edges.size(), points = r.points.size(),
                    leaves = r.leaves.size() - 1;
  return !r.leaves.empty() && r.bounds.size() == leaves && r.thin.size() == leaves &&
         r.owners.size() == faces + 1 && r.faces.size() == faces && r.enclosed.size() == faces &&
         r.edges.size() == edges && r.vertices.size() == points && r.places.corners.size() == faces &&
         r.places.edges.size() == edges && r.places.neighbours.size() == points &&
         mesh::are_rows(r.places.fans, points) && r.places.fans.items.size() == 3 * faces &&
         s.inverted.size() == s.mesh.triangles.size() && s.sliver.size() == s.mesh.triangles.size() &&
         s.normals.face.size() == s.mesh.triangles.size() &&
         s.normals.vertex.size() == s.mesh.positions.size();
}

bool match_leaves(const SitesData& s) {
  const Regions& r = s.regions;
  const std::vector<std::uint32_t> leaves = tree::leaf_nodes(s.tree);
  if (leaves.size() != r.bounds.size() || r.leaves.back() != s.tree.items.size()) return false;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const tree::AabbTree::Node& leaf = s.tree.nodes[leaves[i]];
    if (r.leaves[i] != leaf.first || r.thin[i] >> leaf.count != 0) return false;
  }
  return true;
}

// Each face that has edges is in the tree, once; each edge and each vertex of these faces has one region.
bool are_permutations(const SitesData& s) {
  const Regions& r = s.regions;
  std::vector<std::uint8_t> face(s.mesh.triangles.size(), 0), edge(s.topology.edges.size(), 0),
      vertex(s.mesh.positions.size(), 0);
  const auto first_time = [](std::vector<std::uint8_t>& seen, std::uint32_t i) {
    return i < seen.size() && seen[i]++ == 0;
  };
  for (const std::uint32_t f : s.tree.items)
    if (!first_time(face, f) || s.topology.ignored(f)) return false;
  if (3 * s.tree.items.size() != s.vertex_faces.items.size()) return false;
  for (const EdgeRegion& region : r.edges)
    if (!first_time(edge, region.edge)) return false;
  for (std::size_t v = 0; v < r.points.size(); ++v)
    if (!first_time(vertex, r.points[v].vertex) || r.vertices[v].vertex != r.points[v].vertex) return false;
  return true;
}

// The corners of a face, and the edges and vertices that it owns, which must be its own.
bool matches_owner(const SitesData& s, std::size_t i) {
  const Regions& r = s.regions;
  const Regions::Owner &own = r.owners[i], &next = r.owners[i + 1];
  if (own.face != s.tree.items[i] || next.edges < own.edges || next.edges > r.edges.size() ||
      next.vertices < own.vertices || next.vertices > r.points.size())
    return false;
  const Triangle &corners = r.places.corners[i], &triangle = s.mesh.triangles[own.face];
  for (int k = 0; k < 3; ++k)
    if (corners[k] >= r.points.size() || r.points[corners[k]].vertex != triangle[k]) return false;
  const auto& edges = s.topology.face_edges[own.face];
  for (std::uint32_t e = own.edges; e < next.edges; ++e)
    if (std::ranges::find(edges, r.edges[e].edge) == edges.end()) return false;
  for (std::uint32_t v = own.vertices; v < next.vertices; ++v)
    if (std::ranges::find(corners, v) == corners.end()) return false;
  return true;
}

bool matches_edge(const SitesData& s, std::size_t e) {
  const Regions& r = s.regions;
  const SitePlaces::Edge& place = r.places.edges[e];
  for (const std::uint32_t corner : place.corners)
    if (corner >= r.points.size()) return false;
  const auto& ends = s.topology.edges[r.edges[e].edge];
  return r.points[place.corners[0]].vertex == ends[0] && r.points[place.corners[1]].vertex == ends[1] &&
         place.faces[0] < r.faces.size() && place.faces[1] < r.faces.size();
}

bool matches_vertex(const SitesData& s, std::size_t v) {
  const SitePlaces& places = s.regions.places;
  for (const std::uint32_t neighbour : places.neighbours[v])
    if (neighbour >= s.regions.points.size()) return false;
  const auto fan = places.fans.of(v);
  return std::ranges::all_of(fan, [&](std::uint32_t corner) {
    return corner / 4 < places.corners.size() && corner % 4 < 3 &&
           places.corners[corner / 4][corner % 4] == v;
  });
}

template <class Matches>
bool all_match(std::size_t count, const Matches& matches) {
  for (std::size_t i = 0; i < count; ++i)
    if (!matches(i)) return false;
  return true;
}

}  // namespace

bool match(const SitesData& s) {
  const Regions& r = s.regions;
  if (!has_sizes(s)) return false;
  const Regions::Owner &first = r.owners.front(), &last = r.owners.back();
  if (first.edges != 0 || first.vertices != 0 || last.face != kNone || last.edges != r.edges.size() ||
      last.vertices != r.points.size())
    return false;
  bool leaves = false, permutations = false, owners = false, edges = false, vertices = false;
  permutations = are_permutations(s);
  if (!permutations) return false;
  parallel_invoke(
      [&] {
        leaves = match_leaves(s);
        owners = all_match(r.faces.size(), [&](std::size_t i) { return matches_owner(s, i); });
      },
      [&] {
        edges = all_match(r.edges.size(), [&](std::size_t e) { return matches_edge(s, e); });
        vertices = all_match(r.points.size(), [&](std::size_t v) { return matches_vertex(s, v); });
      });
  return leaves && owners && edges && vertices;
}

}  // namespace sdm::sites
