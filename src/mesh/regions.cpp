#include "mesh/regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/compute_regions.h"
#include "mesh/spread_neighbours.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 1024;  // faces

// Whether the faces around the sites that a face owns, all turned alike, enclose them.
bool encloses(const RegionSource& s, const Regions& regions, std::size_t owner) {
  const auto inner = [&](std::uint32_t edge) { return s.topology.edge_faces(edge).size() == 2; };
  const Regions::Owner &own = regions.owners[owner], &next = regions.owners[owner + 1];
  for (std::uint32_t e = own.edges; e < next.edges; ++e)
    if (!inner(regions.edges[e].edge)) return false;
  for (std::uint32_t v = own.vertices; v < next.vertices; ++v) {
    const std::uint32_t vertex = regions.vertices[v].vertex;
    for (const std::uint32_t face : s.vertex_faces.of(vertex))
      for (int k = 0; k < 3; ++k) {
        const bool at_vertex = s.triangles[face][k] == vertex || s.triangles[face][(k + 1) % 3] == vertex;
        if (at_vertex && !inner(s.topology.face_edges[face][k])) return false;
      }
  }
  return true;
}

// Sites in the order in which they are first offered.
class HandOut {
 public:
  explicit HandOut(std::size_t count) : taken_(count, 0) { order_.reserve(count); }

  void offer(std::uint32_t site) {
    if (!std::exchange(taken_[site], 1)) order_.push_back(site);
  }
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(order_.size()); }

 private:
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> order_;
};

// The slope of the bounds of a face and what it owns: the tangent of the largest angle between its normal and
// those of the faces around.
float slope(const RegionSource& s, const Regions& regions, const FaceShapes& shapes, std::size_t owner) {
  constexpr float kOpen = 1e18f;
  constexpr double kSteepest = 20;    // more counts as open
  constexpr double kRounding = 1e-6;  // of single precision
  const Regions::Owner &own = regions.owners[owner], &next = regions.owners[owner + 1];
  if (shapes.thin[own.face] || !regions.enclosed[owner]) return kOpen;
  const Vec3& normal = shapes.normal[own.face];
  double cosine = 1;
  std::uint8_t thin = 0;
  const auto include = [&](std::uint32_t face) {
    cosine = std::min(cosine, dot(normal, shapes.normal[face]));
    thin |= shapes.thin[face];
  };
  for (std::uint32_t e = own.edges; e < next.edges; ++e) {
    const auto faces = s.topology.edge_faces(regions.edges[e].edge);  // two, for they enclose the edge
    include(faces[0]);
    include(faces[1]);
  }
  for (std::uint32_t v = own.vertices; v < next.vertices; ++v)
    for (const std::uint32_t face : s.vertex_faces.of(regions.vertices[v].vertex)) include(face);
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  if (thin || !(sine < kSteepest * cosine)) return kOpen;
  return static_cast<float>((1 + kRounding) * (sine / cosine) + kRounding);
}

}  // namespace

Regions hand_out_sites(const RegionSource& s, const AabbTree& tree) {
  Regions regions;
  regions.leaves.reserve(tree.nodes.size() / 2 + 2);
  for (const AabbTree::Node& node : tree.nodes)
    if (node.leaf()) regions.leaves.push_back(node.first);
  regions.leaves.push_back(static_cast<std::uint32_t>(tree.items.size()));

  HandOut edges(s.topology.edges.size()), vertices(s.positions.size());
  regions.owners.reserve(tree.items.size() + 1);
  for (const std::uint32_t face : tree.items) {
    regions.owners.push_back({face, edges.count(), vertices.count()});
    for (const std::uint32_t edge : s.topology.face_edges[face]) edges.offer(edge);
    for (const std::uint32_t vertex : s.triangles[face]) vertices.offer(vertex);
  }
  regions.owners.push_back({kNone, edges.count(), vertices.count()});

  regions.bounds.resize(regions.leaves.size() - 1);
  regions.faces.resize(tree.items.size());
  regions.edges.resize(edges.count());
  regions.vertices.resize(vertices.count());
  regions.neighbours.resize(vertices.count());
  regions.enclosed.resize(tree.items.size());
  const VertexNeighbours neighbours = vertex_neighbours(s.positions.size(), s.topology);
  const bool closed = s.topology.closed();
  parallel_for(tree.items.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::uint32_t e = regions.owners[begin].edges; e < regions.owners[end].edges; ++e)
      regions.edges[e].edge = edges.order()[e];
    for (std::uint32_t v = regions.owners[begin].vertices; v < regions.owners[end].vertices; ++v) {
      const std::uint32_t vertex = vertices.order()[v];
      regions.vertices[v].vertex = vertex;
      regions.neighbours[v] = spread_neighbours(s, vertex, neighbours.of(vertex));
    }
    for (std::size_t i = begin; i < end; ++i)
      regions.enclosed[i] = s.orientable && (closed || encloses(s, regions, i));
  });
  return regions;
}

FaceShapes refit(Regions& regions, const RegionSource& source) {
  constexpr std::size_t kLeaves = 128;
  FaceShapes shapes(source.triangles.size());
  parallel_for(regions.bounds.size(), kLeaves, [&](std::size_t begin, std::size_t end) {
    compute_faces(regions, source, shapes, begin, end);
  });
  parallel_for(regions.bounds.size(), kLeaves, [&](std::size_t begin, std::size_t end) {
    const std::uint32_t first = regions.leaves[begin], last = regions.leaves[end];
    compute_edges(regions, source, shapes, regions.owners[first].edges, regions.owners[last].edges);
    compute_vertices(regions, source, regions.owners[first].vertices, regions.owners[last].vertices);
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      for (std::uint32_t i = regions.leaves[leaf]; i < regions.leaves[leaf + 1]; ++i)
        regions.bounds[leaf].slope[i - regions.leaves[leaf]] = slope(source, regions, shapes, i);
  });
  return shapes;
}

}  // namespace sdm
