#include "sites/check_regions.h"

#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <vector>

#include "core/arrays/check_rows.h"
#include "core/parallel_all.h"
#include "sites/check_numbers.h"
#include "tree/fold.h"

namespace sdm::sites {
namespace {

// Sites of a range are checked one after the other for all that is asked of them, while they are in the
// cache.
constexpr std::size_t kCheckedSites = 2048, kCheckedLeaves = 512;

bool has_sizes(const SitesData& s) {
  const Regions& r = s.regions;
  const std::size_t faces = s.tree.items.size(), edges = s.topology.edges.size(), points = r.points.size(),
                    leaves = r.leaves.size() - 1;
  return !r.leaves.empty() && r.bounds.size() == leaves && r.thin.size() == leaves &&
         r.owners.size() == faces + 1 && r.faces.size() == faces && r.enclosed.size() == faces &&
         r.edges.size() == edges && r.vertices.size() == points && r.places.corners.size() == faces &&
         r.places.edges.size() == edges && r.places.neighbours.size() == points &&
         r.places.fans.offsets.size() == points + 1 && s.inverted.size() == s.mesh.triangles.size() &&
         s.sliver.size() == s.mesh.triangles.size() && s.normals.face.size() == s.mesh.triangles.size() &&
         s.normals.vertex.size() == s.mesh.positions.size() && 3 * faces == s.vertex_faces.items.size();
}

bool have_ends(const Regions& r) {
  const Regions::Owner &first = r.owners.front(), &last = r.owners.back();
  return first.edges == 0 && first.vertices == 0 && last.face == kNone && last.edges == r.edges.size() &&
         last.vertices == r.points.size();
}

std::span<const double> numbers_of(const Array<Vec3>& vectors) {
  return {vectors.empty() ? nullptr : vectors[0].data(), 3 * vectors.size()};
}

// Angles add up to at most a straight one a face.
bool have_limits(const Pseudonormals& normals, std::size_t faces) {
  return are_within(numbers_of(normals.face), 1.001) &&
         are_within(numbers_of(normals.vertex), 4.0 * static_cast<double>(faces));
}

// Which indices have occurred, as several threads find them.
class Seen {
 public:
  explicit Seen(std::size_t size) : seen_(size) {}
  [[nodiscard]] bool add(std::uint32_t i) {
    if (i >= seen_.size()) return false;
    std::atomic_ref(seen_[i]).store(1, std::memory_order_relaxed);
    return true;
  }
  [[nodiscard]] std::size_t count() const {
    std::uint32_t count = 0;
    for (const std::uint8_t one : seen_) count += one;
    return count;
  }
  [[nodiscard]] bool all() const { return std::memchr(seen_.data(), 0, seen_.size()) == nullptr; }

 private:
  std::vector<std::uint8_t> seen_;
};

// 0 if they are the same to the bit.
std::uint64_t difference(const float (&a)[3], const float (&b)[3]) {
  std::uint64_t x, y;
  std::uint32_t x2, y2;
  std::memcpy(&x, a, sizeof x);
  std::memcpy(&y, b, sizeof y);
  std::memcpy(&x2, a + 2, sizeof x2);
  std::memcpy(&y2, b + 2, sizeof y2);
  return (x ^ y) | (x2 ^ y2);
}

// Faults are the sums, by bits, of numbers that are 0 where all is as it must be; only indices are tested
// before they are used.
//
// Edges and vertices have their places in the order in which the faces of the tree meet them, and belong to
// the face that meets them first: that of a vertex is the first one in its row of faces, and a face that does
// not meet the next edge first meets earlier ones. No vertex has two places if there are as many places as
// vertices that have faces, and no face is in the tree twice if there are as many as have edges, which the
// number of faces of all vertices says.
class RegionCheck {
 public:
  explicit RegionCheck(const SitesData& sites)
      : s_(sites),
        r_(sites.regions),
        leaves_(tree::leaf_nodes(sites.tree)),
        placed_(std::make_unique_for_overwrite<PaddedPoint[]>(r_.points.size())),
        edge_at_(r_.edges.size() + 1, kNone),
        faces_(sites.mesh.triangles.size()),
        edges_(sites.topology.edges.size()) {}

  bool run() {
    if (leaves_.size() != r_.bounds.size() || r_.leaves.back() != s_.tree.items.size() ||
        r_.largest_radius > kUnitReach)
      return false;
    bool valid_sites = false, valid_fans = false;
    parallel_invoke(
        [&] {
          valid_sites = all(r_.points.size(), kCheckedSites, &RegionCheck::vertices) &&
                        all(r_.edges.size(), kCheckedSites, &RegionCheck::edges);
        },
        [&] { valid_fans = fans(); });
    return valid_sites && valid_fans && all(leaves_.size(), kCheckedLeaves, &RegionCheck::leaves) &&
           all(r_.points.size(), kCheckedSites, &RegionCheck::owners) && edges_.all() &&
           faces_.count() == s_.tree.items.size() && vertices_with_faces() == r_.points.size();
  }

 private:
  bool all(std::size_t count, std::size_t grain, bool (RegionCheck::*valid)(std::size_t, std::size_t)) {
    return parallel_all(count, grain,
                        [&](std::size_t begin, std::size_t end) { return (this->*valid)(begin, end); });
  }

  bool vertices(std::size_t begin, std::size_t end) {
    const auto own = [&](const auto& array) { return std::span(array).subspan(begin, end - begin); };
    const std::span<const VertexRegion> regions = own(r_.vertices);
    const std::span<const UnitVertex> points = own(r_.points);
    const std::span neighbours = own(r_.places.neighbours);
    if (!have_limits(regions) ||
        !are_below({neighbours[0].data(), neighbours[0].size() * neighbours.size()}, r_.points.size()))
      return false;
    std::uint32_t fault = 0;
    for (std::size_t v = 0; v < points.size(); ++v) {
      if (points[v].vertex >= s_.mesh.positions.size()) return false;
      fault |= regions[v].vertex ^ points[v].vertex;
    }
    return fault == 0 &&
           are_placed(s_.frame, s_.mesh.positions, points, regions, {placed_.get() + begin, end - begin});
  }

  bool edges(std::size_t begin, std::size_t end) {
    const std::span<const EdgeRegion> regions(r_.edges);
    const std::span<const SitePlaces::Edge> places(r_.places.edges);
    const std::span<const UnitVertex> points(r_.points);
    const std::span<const std::array<std::uint32_t, 2>> edges(s_.topology.edges);
    if (!have_limits(regions.subspan(begin, end - begin)) ||
        !are_below(places.subspan(begin, end - begin), points.size(), r_.faces.size()))
      return false;
    std::uint64_t fault = 0;
    for (std::size_t e = begin; e < end; ++e) {
      const std::uint32_t edge = regions[e].edge;
      if (!edges_.add(edge)) return false;
      edge_at_[e] = edge;
      const UnitVertex &start = points[places[e].corners[0]], &other = points[places[e].corners[1]];
      fault |= (start.vertex ^ edges[edge][0]) | (other.vertex ^ edges[edge][1]);
      fault |= difference(regions[e].start, start.point);
    }
    return fault == 0;
  }

  bool leaves(std::size_t begin, std::size_t end) {
    const std::span<const tree::AabbTree::Node> nodes(s_.tree.nodes);
    const std::span<const std::uint32_t> leaves = std::span(leaves_).subspan(begin, end - begin);
    const std::uint32_t first = nodes[leaves.front()].first,
                        last = nodes[leaves.back()].first + nodes[leaves.back()].count;
    const std::span<const Triangle> corners(r_.places.corners);
    if (!have_limits(std::span<const FaceRegion>(r_.faces).subspan(first, last - first)) ||
        !have_faces(first, last))
      return false;
    std::uint32_t fault = 0;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      const tree::AabbTree::Node& node = nodes[leaves_[leaf]];
      fault |= (r_.leaves[leaf] ^ node.first) | (r_.thin[leaf] >> node.count);
    }
    return fault == 0 && have_limits(nodes, leaves, std::span(r_.bounds).subspan(begin), r_.largest_radius) &&
           contain(nodes, leaves, corners, {placed_.get(), r_.points.size()});
  }

  // Whether faces have the corners and sides of those in the tree, and meet the next edges.
  bool have_faces(std::uint32_t first, std::uint32_t last) {
    const std::span<const UnitVertex> points(r_.points);
    const std::span<const Triangle> corners(r_.places.corners), triangles(s_.mesh.triangles);
    const std::span<const std::array<std::uint32_t, 3>> face_edges(s_.topology.face_edges);
    const std::span<const Regions::Owner> owners(r_.owners);
    const std::span<const std::uint32_t> items(s_.tree.items), edge_at(edge_at_);
    std::uint32_t next = owners[first].edges, fault = 0;
    for (std::uint32_t i = first; i < last; ++i) {
      const Regions::Owner& own = owners[i];
      if (!faces_.add(own.face) || next >= edge_at.size()) return false;
      const Triangle& triangle = triangles[own.face];
      const std::array<std::uint32_t, 3>& sides = face_edges[own.face];
      if (sides[0] == kNone) return false;
      fault |= (own.face ^ items[i]) | (own.edges ^ next);
      fault |= owners[i + 1].vertices - own.vertices > 3 ? 1 : 0;
      for (int k = 0; k < 3; ++k) {
        fault |= points[corners[i][k]].vertex ^ triangle[k];
        next += edge_at[next] == sides[k] ? 1 : 0;  // none, which is no side, is at the end
      }
    }
    return (fault | (owners[last].edges ^ next)) == 0;
  }

  // Whether each vertex belongs to the first of its faces. Fans must be valid.
  bool owners(std::size_t begin, std::size_t end) {
    const std::span<const Regions::Owner> owners(r_.owners);
    const std::span<const std::uint32_t> offsets(r_.places.fans.offsets), fans(r_.places.fans.items);
    bool valid = true;
    for (std::size_t v = begin; v < end; ++v) {
      if (offsets[v] == offsets[v + 1]) return false;
      const std::uint32_t face = fans[offsets[v]] / 4;
      valid &= (owners[face].vertices <= v) & (v < owners[face + 1].vertices);
    }
    return valid;
  }

  // Whether each vertex has the corners of faces that are at it.
  [[nodiscard]] bool fans() const {
    RowCheck rows(r_.places.fans);
    const std::span<const Triangle> corners(r_.places.corners);
    for (std::uint32_t f = 0; f < corners.size(); ++f)
      for (std::uint32_t k = 0; k < 3; ++k)
        if (corners[f][k] >= r_.points.size() || !rows.put(corners[f][k], 4 * f + k)) return false;
    return rows.complete();
  }

  [[nodiscard]] std::size_t vertices_with_faces() const {
    const std::span<const std::uint32_t> offsets(s_.vertex_faces.offsets);
    std::uint32_t count = 0;
    for (std::size_t v = 0; v + 1 < offsets.size(); ++v) count += offsets[v] != offsets[v + 1] ? 1 : 0;
    return count;
  }

  const SitesData& s_;
  const Regions& r_;
  const std::vector<std::uint32_t> leaves_;      // nodes
  const std::unique_ptr<PaddedPoint[]> placed_;  // of each vertex that has a region
  std::vector<std::uint32_t> edge_at_;           // of each place, and none
  Seen faces_, edges_;
};

}  // namespace

bool match(const SitesData& s) {
  return has_sizes(s) && have_ends(s.regions) && have_limits(s.normals, s.regions.faces.size()) &&
         RegionCheck(s).run();
}

}  // namespace sdm::sites
