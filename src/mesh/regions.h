// The regions of influence of sites, laid out for vector instructions.
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

#include "hierarchy/aabb_tree.h"
#include "mesh/topology.h"

namespace sdm {

/// Sites that are tested together. `face` is a face that the site belongs to. Coordinates in the unit frame;
/// all normals and directions have length 1, or 0 where geometry gives none (and then never exclude
/// anything).
struct RegionBlock {
  static constexpr int kWidth = 8;
};

/// height(x) = plane·(x, −1); inside the prism where every wall·(x, −1) ≥ 0.
struct FaceBlock : RegionBlock {
  alignas(32) float plane[4][kWidth];
  alignas(32) float wall[3][4][kWidth];
  std::uint32_t face[kWidth];
  std::uint32_t count = 0;
};

/// start + t·direction, 0 ≤ t ≤ length; in the wedge where every wall·(x, −1) ≤ 0.
struct EdgeBlock : RegionBlock {
  alignas(32) float start[3][kWidth];
  alignas(32) float direction[3][kWidth];
  alignas(32) float length[kWidth];
  alignas(32) float wall[2][4][kWidth];
  std::uint32_t face[kWidth], edge[kWidth];
  std::uint32_t count = 0;
};

/// In the cone where every ray·(x − point) ≤ 0.
struct VertexBlock : RegionBlock {
  static constexpr int kRays = 4;
  alignas(32) float point[3][kWidth];
  alignas(32) float ray[kRays][3][kWidth];
  std::uint32_t face[kWidth], vertex[kWidth], neighbour[kRays][kWidth];
  std::uint32_t count = 0;
};

/// The sites of every leaf of a tree over the faces; each edge and vertex belongs to one leaf that holds a
/// face of it.
struct Regions {
  struct Leaf {
    std::uint32_t faces, edges, vertices;  ///< its first block of each kind; the next leaf's ends it
  };
  std::vector<Leaf> leaves;  ///< one for each leaf in order, and an end
  std::vector<FaceBlock> faces;
  std::vector<EdgeBlock> edges;
  std::vector<VertexBlock> vertices;
};

/// Hands the sites to the leaves of `tree`, whose items are faces, and computes their regions.
[[nodiscard]] Regions build_regions(std::span<const Vec3> unit_positions, std::span<const Triangle> triangles,
                                    const Topology& topology, const AabbTree& tree);

/// Computes the regions anew for moved vertices. Cost: linear, all cores.
void refit(Regions& regions, std::span<const Vec3> unit_positions, std::span<const Triangle> triangles,
           const Topology& topology);

}  // namespace sdm
