#include <hwy/cache_control.h>

#include <algorithm>
#include <utility>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "sites/cone_rays.h"
#include "sites/regions.h"
#include "tree/fold.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kRegionGrain = 1024;  // faces
constexpr std::size_t kAhead =
    16;  // faces whose data is prefetched, as the tree's order is not that of the mesh

// Whether the faces around the sites owned by a face form closed, consistently oriented fans.
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

// The sites of one kind, in the order in which faces meet them. Most are met several times, in no pattern
// that a processor could predict, so nothing branches on whether one is new.
class SiteOrder {
 public:
  explicit SiteOrder(std::size_t count) : place_(count, kNone), sites_(count + 1) {}

  /// The place of a site: a new one if it has not been met.
  std::uint32_t meet(std::uint32_t site) {
    const std::uint32_t place = std::min(place_[site], count_);
    sites_[count_] = site;
    count_ += place == count_;
    return place_[site] = place;
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// The site at each place.
  [[nodiscard]] std::span<const std::uint32_t> sites() const { return {sites_.data(), count_}; }

 private:
  std::vector<std::uint32_t> place_, sites_;
  std::uint32_t count_ = 0;
};

void order_vertices(const RegionSource& s, std::span<const std::uint32_t> faces, Regions& regions,
                    SiteOrder& vertices) {
  Poll due(kRegionGrain);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    due();
    regions.owners[i].face = faces[i];
    if (i + kAhead < faces.size()) hwy::Prefetch(&s.triangles[faces[i + kAhead]]);
    regions.owners[i].vertices = vertices.count();
    for (int k = 0; k < 3; ++k) regions.places.corners[i][k] = vertices.meet(s.triangles[faces[i]][k]);
  }
  regions.owners.back().face = kNone;
  regions.owners.back().vertices = vertices.count();
}

// As `faces` of each edge, which are kNone at first, stores 4i + k for the first two owners i of which it is
// side k, or for the only one twice.
void order_edges(const RegionSource& s, std::span<const std::uint32_t> faces, Regions& regions,
                 SiteOrder& edges) {
  Poll due(kRegionGrain);
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    due();
    if (i + kAhead < faces.size()) hwy::Prefetch(&s.topology.face_edges[faces[i + kAhead]]);
    regions.owners[i].edges = edges.count();
    for (std::uint32_t k = 0; k < 3; ++k) {
      auto& [first, second] = regions.places.edges[edges.meet(s.topology.face_edges[faces[i]][k])].faces;
      const std::uint32_t side = 4 * i + k, met_twice = first == second ? 0 : ~0u;
      second = (second & met_twice) | (side & ~met_twice);
      first = std::min(first, side);
    }
  }
  regions.owners.back().edges = edges.count();
}

// Completes what order_edges() stored.
void place_corners(Regions& regions, std::span<const std::uint32_t> vertices, std::size_t begin,
                   std::size_t end) {
  constexpr int kNext[] = {1, 2, 0, 1};
  const std::span<const Triangle> corners = regions.places.corners;
  for (std::size_t e = begin; e < end; ++e) {
    SitePlaces::Edge& edge = regions.places.edges[e];
    const auto [i, j] = std::array{edge.faces[0] / 4, edge.faces[1] / 4};
    const std::uint32_t k = edge.faces[0] % 4, a = corners[i][k], b = corners[i][kNext[k]];
    const bool forward = vertices[a] < vertices[b];
    edge.corners[!forward] = a;
    edge.corners[forward] = b;
    edge.corners[2] = corners[i][kNext[k + 1]];
    edge.corners[3] = corners[j][kNext[edge.faces[1] % 4 + 1]];
    edge.faces = {i, j};
  }
}

}  // namespace

Regions build_regions(const RegionSource& s, const tree::AabbTree& tree) {
  Regions regions;
  SitePlaces& places = regions.places;
  SiteOrder edge_order(s.topology.edges.size()), vertex_order(s.positions.size());
  const std::size_t faces = tree.items.size();
  regions.owners.resize(faces + 1);
  places.corners.resize(faces);
  places.edges.assign(s.topology.edges.size(), {{}, {kNone, kNone}});
  parallel_invoke(
      [&] {
        order_edges(s, tree.items, regions, edge_order);
        regions.enclosed.resize(faces);
      },
      [&] {
        order_vertices(s, tree.items, regions, vertex_order);
        regions.faces.resize(faces);
        regions.edges.resize(s.topology.edges.size());
        std::vector<std::uint32_t> leaves = leaf_nodes(tree);
        for (std::uint32_t& leaf : leaves)
          leaf = static_cast<std::uint32_t>(tree.items_of(leaf).data() - tree.items.data());
        leaves.push_back(static_cast<std::uint32_t>(faces));
        leaves.shrink_to_fit();
        regions.leaves = std::move(leaves);
      });
  parallel_for(places.edges.size(), kRegionGrain, [&](std::size_t begin, std::size_t end) {
    place_corners(regions, vertex_order.sites(), begin, end);
  });
  const std::size_t vertices = vertex_order.count();
  CompressedRows<std::uint32_t> neighbours;  // of each vertex, by places
  parallel_invoke(
      [&] {
        neighbours = make_rows<std::uint32_t>(vertices, [&](const auto& put) {
          Poll due(kRegionGrain);
          for (const SitePlaces::Edge& edge : places.edges) {
            due();
            put(edge.corners[0], edge.corners[1]);
            put(edge.corners[1], edge.corners[0]);
          }
        });
      },
      [&] {
        places.fans = make_rows<std::uint32_t>(vertices, [&](const auto& put) {
          Poll due(kRegionGrain);
          for (std::uint32_t f = 0; f < faces; ++f) {
            due();
            for (std::uint32_t k = 0; k < 3; ++k) put(places.corners[f][k], 4 * f + k);
          }
        });
        regions.vertices.resize(vertices);
        regions.points.resize(vertices);
        regions.bounds.resize(regions.leaves.size() - 1);
        regions.thin.resize(regions.bounds.size());
        places.neighbours.resize(vertices);
        for (std::size_t v = 0; v < vertices; ++v)
          regions.vertices[v].vertex = regions.points[v].vertex = vertex_order.sites()[v];
      });
  std::vector<Vec3> placed;
  place(regions, s.positions, placed);
  const bool closed = s.topology.closed();
  parallel_for(faces, kRegionGrain, [&](std::size_t begin, std::size_t end) {
    for (std::uint32_t e = regions.owners[begin].edges; e < regions.owners[end].edges; ++e)
      regions.edges[e].edge = edge_order.sites()[e];
    for (std::uint32_t v = regions.owners[begin].vertices; v < regions.owners[end].vertices; ++v)
      places.neighbours[v] = choose_cone_rays(placed, s.scale, v, neighbours.of(v));
    for (std::size_t i = begin; i < end; ++i)
      regions.enclosed[i] = s.orientable && (closed || encloses(s, regions, i));
  });
  return regions;
}

}  // namespace sdm::sites
