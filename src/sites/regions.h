// The regions of influence of sites.
//
// A site can hold the closest point of x only if x lies in its region, by first-order conditions that any
// soup satisfies:
//   face abc   the prism over it: x on the inner side of the three walls through its edges;
//   edge ab    between the end planes through a and b, and for each incident face, with inward in-plane
//   normal m ⟂ ab:
//              (x − a)·m ≤ 0;
//   vertex v   the polar cone (x − v)·(w − v) ≤ 0 over all incident edges vw.
// Fewer conditions only make a region larger, which is always safe: edges keep two walls, vertices four
// edges.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

#include "geometry/unit_frame.h"
#include "mesh/topology.h"
#include "sites/pseudonormals.h"
#include "tree/aabb_tree.h"

namespace sdm::sites {

// One cache line each, because sites are loaded individually. Coordinates in the unit frame; all normals and
// directions have length 1, or 0 where they are undefined (and then never exclude anything).

/// height(x) = plane·(x, −1); inside the prism where every wall·(x, −1) ≥ 0.
struct alignas(64) FaceRegion {
  float plane[4], wall[3][4];
};

/// start + t·direction, 0 ≤ t ≤ length; in the wedge where every wall·(x, −1) ≤ 0.
struct alignas(64) EdgeRegion {
  float start[3], direction[3], length, wall[2][4];
  std::uint32_t edge;
};

/// The cone where every ray·(x − point) ≤ 0.
struct alignas(64) VertexRegion {
  static constexpr int kRays = 4;
  float point[3], ray[kRays][3];
  std::uint32_t vertex;
};

/// A vertex without its region: the corners of a face are loaded together, and four share a cache line.
struct alignas(16) UnitVertex {
  float point[3];
  std::uint32_t vertex;
};

/// Bounds for up to eight faces, tested together: x lies in the region of a face, or of an edge or vertex
/// that the face owns, only if with r = x − centre and h = normal·r
///   |r − h normal| ≤ radius + slope |h|.
/// This holds because all of these sites lie in a disc of the face's plane. Where the faces around them form
/// a closed fan whose normals are within some angle of this normal, so is, up to its sign, the direction from
/// a site to any x of its region: slope is the tangent of that angle. (In polar cones: above any direction u
/// in the plane the sheet around a vertex v has a point v + u + s normal, |s| ≤ slope; for u the direction of
/// x − v in the plane, (x − v)·(u + s normal) ≤ 0 says |x − v in the plane| ≤ slope |h|.) Elsewhere slope is
/// kOpen.
struct FaceBounds {
  static constexpr int kWidth = 8;
  static constexpr float kOpen = 1e18f;  ///< elsewhere, and where a face is too thin for a reliable normal
  alignas(32) float centre[3][kWidth];   ///< a point of the face
  alignas(32) float normal[3][kWidth];
  alignas(32) float radius[kWidth];
  alignas(32) float slope[kWidth];
};

/// A copy of the topology in which faces, edges and vertices are indexed by region. Refits read it
/// sequentially, and its indices refer to nearby memory.
struct SitePlaces {
  struct Edge {
    std::array<std::uint32_t, 4> corners;  ///< its ends, and the third corners of its first two faces
    std::array<std::uint32_t, 2> faces;    ///< these faces, or the only one twice
  };
  Array<Triangle> corners;  ///< of each face
  Array<Edge> edges;
  Array<std::array<std::uint32_t, VertexRegion::kRays>> neighbours;  ///< of each vertex: ends of rays
  CompressedRows<std::uint32_t> fans;  ///< of each vertex: 4f + k for each face f, of which it is corner k

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [corners, edges, neighbours, fans] = self;
    visit(corners);
    visit(edges);
    visit(neighbours);
    visit(fans);
  }
};

/// The sites, in the order of the leaves of a tree over the faces. Each edge and vertex is owned by the first
/// of its faces.
struct Regions {
  /// A face, and the first of the edges and vertices that it owns; they end at those of the next entry.
  struct Owner {
    std::uint32_t face, edges, vertices;
  };
  Array<std::uint32_t> leaves;  ///< the first face of each leaf, in the order of owners; and an end
  Array<FaceBounds> bounds;     ///< of each leaf
  Array<std::uint8_t> thin;     ///< of each leaf: a bit for each face whose normal may be unreliable
  Array<Owner> owners;          ///< one for each face in the tree's order, and an end
  Array<FaceRegion> faces;      ///< of each owner
  Array<EdgeRegion> edges;
  Array<VertexRegion> vertices;
  Array<UnitVertex> points;  ///< of vertices
  float largest_radius = 0;  ///< of `bounds`

  Array<std::uint8_t> enclosed;  ///< of each owner: whether the faces around it form a closed sheet
  SitePlaces places;

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [leaves, bounds, thin, owners, faces, edges, vertices, points, largest_radius, enclosed, places] =
        self;
    visit(leaves);
    visit(bounds);
    visit(thin);
    visit(owners);
    visit(faces);
    visit(edges);
    visit(vertices);
    visit(points);
    visit(largest_radius);
    visit(enclosed);
    visit(places);
  }
};

/// The input from which regions are built.
struct RegionSource {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const mesh::Topology& topology;
  const mesh::VertexFaces& vertex_faces;
  bool orientable;
  double scale;  ///< of the frame that regions are in
};

/// Assigns the sites to the leaves of `tree`, whose items are faces, at most FaceBounds::kWidth per leaf.
/// refit() computes their regions. Cost: linear, all cores.
[[nodiscard]] Regions build_regions(const RegionSource& source, const tree::AabbTree& tree);

/// Sets `placed` to the positions in the order of the regions' vertices. Refits read each position several
/// times, and this order follows the tree, while that of a mesh is arbitrary. Cost: linear, all cores.
void place(const Regions& regions, std::span<const Vec3> positions, std::vector<Vec3>& placed);

/// Sets `boxes` to those of the leaves. Cost: linear, all cores.
void find_leaf_boxes(const Regions& regions, const UnitFrame& frame, std::span<const Vec3> placed,
                     std::vector<tree::FloatBox>& boxes);

struct FaceShape {
  Vec3 normal;  ///< unit length, outward, 0 without area
  Vec3 angle;   ///< at each corner
  bool thin;    ///< too thin for a prism in single precision: represented by its edges
  bool sliver;  ///< too thin for a reliable normal
};

/// The present positions of the vertices, and the orientation of the faces.
struct Placement {
  const UnitFrame& frame;                  ///< in which regions are computed
  std::span<const Vec3> vertices;          ///< see place()
  std::span<const std::uint8_t> inverted;  ///< of each face of the mesh: clockwise as seen from outside
};

/// Computes the regions, and the data that signs require: pseudonormals, which point outwards if `inverted`
/// is correct, and which faces are slivers, too thin for reliable normals. `shapes`, one per owner, are
/// intermediate results. Cost: linear, all cores.
void refit(Regions& regions, const Placement& placement, Pseudonormals& normals, Array<std::uint8_t>& sliver,
           std::vector<FaceShape>& shapes);

}  // namespace sdm::sites
