#include "sites/check_regions.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <vector>

#include "core/parallel_all.h"
#include "geometry/vec.h"
#include "mesh/check_topology.h"
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
         mesh::are_rows(r.places.fans, points) && r.places.fans.items.size() == 3 * faces &&
         s.inverted.size() == s.mesh.triangles.size() && s.sliver.size() == s.mesh.triangles.size() &&
         s.normals.face.size() == s.mesh.triangles.size() &&
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

// Which indices have occurred, as several threads find them. Of `count` indices none occurs twice if `count`
// have occurred.
class Seen {
 public:
  explicit Seen(std::size_t size) : seen_(size) {}
  [[nodiscard]] bool add(std::uint32_t i) {
    if (i >= seen_.size()) return false;
    std::atomic_ref(seen_[i]).store(1, std::memory_order_relaxed);
    return true;
  }
  [[nodiscard]] std::size_t count() const {
    std::size_t count = 0;
    for (const std::uint8_t one : seen_) count += one;
    return count;
  }
  [[nodiscard]] bool has(std::size_t i) const { return seen_[i] != 0; }

 private:
  std::vector<std::uint8_t> seen_;
};

// 0 if all indices are below the count.
template <class Indices>
std::uint32_t beyond(const Indices& indices, std::size_t count) {
  std::uint32_t any = 0;
  for (const std::uint32_t i : indices) any |= i >= count ? 1 : 0;
  return any;
}

// 0 if x is one of the three.
std::uint32_t missing(const Triangle& three, std::uint32_t x) {
  return (three[0] != x ? 1 : 0) & (three[1] != x ? 1 : 0) & (three[2] != x ? 1 : 0);
}

// 0 if they are the same to the bit.
std::uint32_t difference(const float (&a)[3], const float (&b)[3]) {
  std::uint32_t x[3], y[3];
  std::memcpy(x, a, sizeof x);
  std::memcpy(y, b, sizeof y);
  return (x[0] ^ y[0]) | (x[1] ^ y[1]) | (x[2] ^ y[2]);
}

// Faults are the sums, by bits, of numbers that are 0 where all is as it must be; only indices are tested
// before they are used.
class RegionCheck {
 public:
  explicit RegionCheck(const SitesData& sites)
      : s_(sites),
        r_(sites.regions),
        leaves_(tree::leaf_nodes(sites.tree)),
        placed_(r_.points.size()),
        faces_(sites.mesh.triangles.size()),
        edges_(sites.topology.edges.size()),
        vertices_(sites.mesh.positions.size()) {}

  // Each face that has edges is in the tree, once; each edge and each vertex of these faces has one region.
  bool run() {
    return leaves_.size() == r_.bounds.size() && r_.leaves.back() == s_.tree.items.size() &&
           r_.largest_radius <= kUnitReach && all(r_.points.size(), kCheckedSites, &RegionCheck::vertices) &&
           all(r_.edges.size(), kCheckedSites, &RegionCheck::edges) &&
           all(leaves_.size(), kCheckedLeaves, &RegionCheck::leaves) &&
           vertices_.count() == r_.points.size() && edges_.count() == r_.edges.size() && have_all_faces();
  }

 private:
  bool all(std::size_t count, std::size_t grain, bool (RegionCheck::*valid)(std::size_t, std::size_t)) {
    return parallel_all(count, grain,
                        [&](std::size_t begin, std::size_t end) { return (this->*valid)(begin, end); });
  }

  bool vertices(std::size_t begin, std::size_t end) {
    const std::span<const VertexRegion> regions(r_.vertices);
    const std::span<const UnitVertex> points(r_.points);
    const std::span<const std::uint32_t> corners(r_.places.corners[0].data(), 3 * r_.places.corners.size());
    const std::span<const std::uint32_t> offsets(r_.places.fans.offsets), fans(r_.places.fans.items);
    const std::span<PaddedPoint> placed(placed_);
    const UnitFrame frame = s_.frame;
    if (!have_limits(regions.subspan(begin, end - begin))) return false;
    std::uint32_t fault = 0;
    for (std::size_t v = begin; v < end; ++v) {
      const UnitVertex& point = points[v];
      const VertexRegion& region = regions[v];
      fault |= region.vertex ^ point.vertex;
      fault |= beyond(r_.places.neighbours[v], points.size());
      if (!vertices_.add(point.vertex)) return false;
      const Vec3 unit = frame.to_unit(s_.mesh.positions[point.vertex]);
      placed[v] = {unit[0], unit[1], unit[2], 0};
      const float p[] = {static_cast<float>(unit[0]), static_cast<float>(unit[1]),
                         static_cast<float>(unit[2])};
      fault |= difference(point.point, p) | difference(region.point, p);
      for (std::uint32_t i = offsets[v]; i < offsets[v + 1]; ++i) {
        const std::uint32_t fan = fans[i], corner = fan - fan / 4;  // 3f + k
        if (corner >= corners.size()) return false;
        fault |= corners[corner] ^ static_cast<std::uint32_t>(v);
        fault |= fan & fan >> 1 & 1;  // k = 3
      }
    }
    return fault == 0;
  }

  bool edges(std::size_t begin, std::size_t end) {
    const std::span<const EdgeRegion> regions(r_.edges);
    const std::span<const SitePlaces::Edge> places(r_.places.edges);
    const std::span<const UnitVertex> points(r_.points);
    const std::span<const std::array<std::uint32_t, 2>> edges(s_.topology.edges);
    const std::size_t faces = r_.faces.size();
    if (!have_limits(regions.subspan(begin, end - begin))) return false;
    std::uint32_t fault = 0;
    for (std::size_t e = begin; e < end; ++e) {
      const EdgeRegion& region = regions[e];
      const SitePlaces::Edge& place = places[e];
      if (!edges_.add(region.edge) || beyond(place.corners, points.size()) != 0) return false;
      const auto& ends = edges[region.edge];
      const UnitVertex &start = points[place.corners[0]], &other = points[place.corners[1]];
      fault |= (start.vertex ^ ends[0]) | (other.vertex ^ ends[1]) | beyond(place.faces, faces);
      fault |= difference(region.start, start.point);
    }
    return fault == 0;
  }

  bool leaves(std::size_t begin, std::size_t end) {
    const std::span<const tree::AabbTree::Node> nodes(s_.tree.nodes);
    const std::span<const Triangle> corners(r_.places.corners);
    const std::uint32_t first = nodes[leaves_[begin]].first;
    const tree::AabbTree::Node& last = nodes[leaves_[end - 1]];
    if (!have_limits(std::span<const FaceRegion>(r_.faces).subspan(first, last.first + last.count - first)))
      return false;
    std::uint32_t fault = 0;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      const tree::AabbTree::Node& node = nodes[leaves_[leaf]];
      fault |= (r_.leaves[leaf] ^ node.first) | (r_.thin[leaf] >> node.count);
      if (!have_limits(r_.bounds[leaf], node.count, r_.largest_radius) ||
          !have_faces(node.first, node.count) ||
          !contains(node.box, corners.subspan(node.first, node.count), placed_))
        return false;
    }
    return fault == 0;
  }

  // Whether the faces of a leaf have the right corners, and own edges between these and vertices among them.
  bool have_faces(std::uint32_t first, std::uint32_t count) {
    const std::span<const UnitVertex> points(r_.points);
    const std::span<const Triangle> corners(r_.places.corners), triangles(s_.mesh.triangles);
    const std::span<const Regions::Owner> owners = std::span<const Regions::Owner>(r_.owners);
    const Regions::Owner begin = owners[first], end = owners[first + count];
    if (end.edges > r_.edges.size() || end.vertices > points.size()) return false;
    // The owner of each edge and vertex, and of up to three more, which that of the next face replaces.
    constexpr std::size_t kMost = 3 * FaceBounds::kWidth + 3;
    std::uint32_t of_edge[kMost], of_vertex[kMost];
    std::uint32_t fault = 0;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Regions::Owner own = owners[i], next = owners[i + 1];
      if (own.face != s_.tree.items[i] || !faces_.add(own.face) || beyond(corners[i], points.size()) != 0 ||
          next.edges - own.edges > 3 || next.vertices - own.vertices > 3)
        return false;
      for (std::uint32_t k = 0; k < 3; ++k) {
        fault |= points[corners[i][k]].vertex ^ triangles[own.face][k];
        of_edge[own.edges - begin.edges + k] = i;
        of_vertex[own.vertices - begin.vertices + k] = i;
      }
    }
    for (std::uint32_t e = begin.edges; e < end.edges; ++e) {
      const Triangle& own = corners[of_edge[e - begin.edges]];
      const auto& ends = r_.places.edges[e].corners;
      fault |= missing(own, ends[0]) | missing(own, ends[1]);
    }
    for (std::uint32_t v = begin.vertices; v < end.vertices; ++v)
      fault |= missing(corners[of_vertex[v - begin.vertices]], v);
    return fault == 0;
  }

  // Whether the faces that have edges, and no others, are in the tree, as many as it has.
  [[nodiscard]] bool have_all_faces() const {
    bool same = true;
    for (std::size_t f = 0; f < s_.topology.face_edges.size(); ++f)
      same &= faces_.has(f) != s_.topology.ignored(f);
    return same;
  }

  const SitesData& s_;
  const Regions& r_;
  const std::vector<std::uint32_t> leaves_;  // nodes
  std::vector<PaddedPoint> placed_;          // of each vertex that has a region
  Seen faces_, edges_, vertices_;
};

}  // namespace

bool match(const SitesData& s) {
  return has_sizes(s) && have_ends(s.regions) && have_limits(s.normals, s.regions.faces.size()) &&
         RegionCheck(s).run();
}

}  // namespace sdm::sites
