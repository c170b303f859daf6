// Which sites of O2 meet which domains of O1: bounds on distance, then oriented boxes, then clipping.
#pragma once

#include <sdm/gl.h>

#include <cstdint>
#include <vector>

#include "engine/gl/domain_tree.h"
#include "engine/gl/raster_polygon.h"

namespace sdm::gl {

/// O2's sites by the leaves of its tree, without those whose region has no interior.
struct SiteIndex {
  const sites::SitesData& sites;
  hierarchy::LeafOrder leaves;
  std::vector<std::uint64_t> before;  ///< sites kept in front of each leaf, and of the end
  std::uint64_t dropped = 0;

  explicit SiteIndex(const sites::SitesData& sites);
};

/// Counts of what became of pairs; see GlReport.
struct PairCounts {
  std::uint64_t bound_tests = 0, obb_tests = 0;
  std::uint64_t culled_by_bound = 0, culled_by_obb = 0, clipped_away = 0, polygons = 0;

  PairCounts& operator+=(const PairCounts& other);
};

/// A subtree of O1's tree, drawn together.
struct DomainBlock {
  std::uint32_t node = 0, end = 0;    ///< its root, and the node after its last
  std::vector<PlanarDomain> domains;  ///< of its leaves, in order
};

/// Subtrees of at most `size` leaves, which together hold all; `domains` are left to be filled.
[[nodiscard]] std::vector<DomainBlock> cut_into_blocks(const DomainTree& tree, std::uint32_t size);

/// The leaves of O2's tree that are within the block's bound, in order. Subtrees left out count in `counts`.
[[nodiscard]] std::vector<std::uint32_t> leaves_within_bound(const SiteIndex& index, const DomainTree& tree,
                                                             const DomainBlock& block, PairCounts& counts);

/// Adds the polygons of all sites of one leaf of O2's tree on the domains of the block. `reach` is the
/// largest distance of interest.
void draw_leaf(const SiteIndex& index, std::uint32_t leaf, const DomainTree& tree, const DomainBlock& block,
               double reach, const RasterScale& scale, RasterBatch& batch, PairCounts& counts);

}  // namespace sdm::gl
