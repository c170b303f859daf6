#include <utility>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "sites/cone_rays.h"
#include "sites/regions.h"
#include "tree/fold.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kRegionGrain = 1024;  // faces

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

// Assigns sites in the order of the faces and builds the topology indexed by region.
class SiteOrder {
 public:
  explicit SiteOrder(const RegionSource& source)
      : s_(source),
        edge_place_(source.topology.edges.size(), kNone),
        vertex_place_(source.positions.size(), kNone) {
    edges_.reserve(edge_place_.size());
    vertices_.reserve(vertex_place_.size());
  }

  void run(std::span<const std::uint32_t> faces, Regions& regions) {
    std::vector<Regions::Owner> owners;
    corners_.reserve(faces.size());
    edge_faces_.reserve(edge_place_.size());
    owners.reserve(faces.size() + 1);
    Poll due(kRegionGrain);
    for (const std::uint32_t face : faces) {
      due();
      owners.push_back(next_owner(face));
      const Triangle& t = s_.triangles[face];
      Triangle& corners = corners_.emplace_back();
      for (int k = 0; k < 3; ++k) corners[k] = place_of(t[k], vertex_place_, vertices_);
      for (int k = 0; k < 3; ++k) meet(s_.topology.face_edges[face][k], t, k);
    }
    owners.push_back(next_owner(kNone));
    regions.owners = std::move(owners);
    regions.places.corners = std::move(corners_);
    regions.places.edges = std::move(edge_faces_);
  }

  // The site at each region index.
  [[nodiscard]] const std::vector<std::uint32_t>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<std::uint32_t>& vertices() const { return vertices_; }

 private:
  [[nodiscard]] Regions::Owner next_owner(std::uint32_t face) const {
    return {face, static_cast<std::uint32_t>(edges_.size()), static_cast<std::uint32_t>(vertices_.size())};
  }

  static std::uint32_t place_of(std::uint32_t site, std::vector<std::uint32_t>& places,
                                std::vector<std::uint32_t>& sites) {
    if (places[site] == kNone) {
      places[site] = static_cast<std::uint32_t>(sites.size());
      sites.push_back(site);
    }
    return places[site];
  }

  // Records that side k of the last face, t, is this edge.
  void meet(std::uint32_t edge, const Triangle& t, int k) {
    const auto face = static_cast<std::uint32_t>(corners_.size() - 1);
    const Triangle& corners = corners_.back();
    const std::uint32_t third = corners[(k + 2) % 3], place = place_of(edge, edge_place_, edges_);
    if (place == edge_faces_.size()) {
      const int from = mesh::runs_forward(t, k) ? k : (k + 1) % 3,
                to = mesh::runs_forward(t, k) ? (k + 1) % 3 : k;
      edge_faces_.push_back({{corners[from], corners[to], third, third}, {face, face}});
    } else if (SitePlaces::Edge& met = edge_faces_[place]; met.faces[1] == met.faces[0]) {
      met.corners[3] = third;
      met.faces[1] = face;
    }
  }

  const RegionSource& s_;
  std::vector<std::uint32_t> edge_place_, vertex_place_;  // kNone: not assigned yet
  std::vector<std::uint32_t> edges_, vertices_;
  std::vector<Triangle> corners_;  // as those of places
  std::vector<SitePlaces::Edge> edge_faces_;
};

}  // namespace

Regions build_regions(const RegionSource& s, const tree::AabbTree& tree) {
  Regions regions;
  SitePlaces& places = regions.places;
  SiteOrder sites(s);
  const std::size_t faces = tree.items.size();
  parallel_invoke(
      [&] {
        regions.faces.resize(faces);
        regions.edges.resize(s.topology.edges.size());
        regions.enclosed.resize(faces);
      },
      [&] {
        sites.run(tree.items, regions);
        std::vector<std::uint32_t> leaves = leaf_nodes(tree);
        for (std::uint32_t& leaf : leaves)
          leaf = static_cast<std::uint32_t>(tree.items_of(leaf).data() - tree.items.data());
        leaves.push_back(static_cast<std::uint32_t>(faces));
        leaves.shrink_to_fit();
        regions.leaves = std::move(leaves);
      });
  const std::size_t vertices = sites.vertices().size();
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
          regions.vertices[v].vertex = regions.points[v].vertex = sites.vertices()[v];
      });
  std::vector<Vec3> placed;
  place(regions, s.positions, placed);
  const bool closed = s.topology.closed();
  parallel_for(faces, kRegionGrain, [&](std::size_t begin, std::size_t end) {
    for (std::uint32_t e = regions.owners[begin].edges; e < regions.owners[end].edges; ++e)
      regions.edges[e].edge = sites.edges()[e];
    for (std::uint32_t v = regions.owners[begin].vertices; v < regions.owners[end].vertices; ++v)
      places.neighbours[v] = choose_cone_rays(placed, s.scale, v, neighbours.of(v));
    for (std::size_t i = begin; i < end; ++i)
      regions.enclosed[i] = s.orientable && (closed || encloses(s, regions, i));
  });
  return regions;
}

}  // namespace sdm::sites
