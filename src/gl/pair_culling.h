// Finds which sites of O2 meet which domains of O1: by distance bounds, then oriented boxes, then clipping.
#pragma once

#include <sdm/gl.h>

#include <cstdint>
#include <vector>

#include "gl/domain_tree.h"
#include "gl/polygons/raster_polygon.h"

namespace sdm::gl {

/// O2's sites by leaf of its tree, without those whose region has no interior.
struct SiteIndex {
  const sites::SitesData& sites;
  tree::LeafOrder leaves;
  std::vector<std::uint64_t> before;  ///< number of sites kept before each leaf, and in total
  std::uint64_t dropped = 0;

  explicit SiteIndex(const sites::SitesData& sites);
};

/// What became of the pairs; see GlReport.
struct PairCounts {
  std::uint64_t bound_tests = 0, obb_tests = 0;
  std::uint64_t culled_by_bound = 0, culled_by_obb = 0, clipped_away = 0, polygons = 0;

  PairCounts& operator+=(const PairCounts& other);
};

/// A subtree of O1's tree that is drawn together.
struct DomainBlock {
  std::uint32_t node = 0, end = 0;    ///< its root, and one past its last node
  std::vector<PlanarDomain> domains;  ///< of its leaves, in order
};

/// Splits the tree into subtrees of at most `size` leaves; leaves `domains` empty.
[[nodiscard]] std::vector<DomainBlock> cut_into_blocks(const DomainTree& tree, std::uint32_t size);

/// The leaves of O2's tree within the block's bound, in order. Subtrees that are culled are added to
/// `counts`.
[[nodiscard]] std::vector<std::uint32_t> leaves_within_bound(const SiteIndex& index, const DomainTree& tree,
                                                             const DomainBlock& block, PairCounts& counts);

/// Adds the polygons of all sites of a leaf of O2's tree on the block's domains. `reach`: the largest
/// distance of interest.
void draw_leaf(const SiteIndex& index, std::uint32_t leaf, const DomainTree& tree, const DomainBlock& block,
               double reach, const RasterRules& rules, RasterBatch& batch, PairCounts& counts);

}  // namespace sdm::gl
