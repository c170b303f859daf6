// Finds which sites of O2 meet which domains of O1: by distance bounds, then oriented boxes, then clipping.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/domain_tree.h"
#include "gl/polygons/oriented_box.h"
#include "gl/polygons/planar_domain.h"
#include "gl/polygons/site_region.h"
#include "tree/visit.h"

namespace sdm::gl {

/// O2's sites by leaf of its tree, without those whose region has no interior.
struct SiteIndex {
  const sites::SitesData& sites;
  tree::LeafOrder leaves;
  std::vector<std::uint64_t> before;  ///< number of sites kept before each leaf, and in total
  std::uint64_t dropped = 0;

  explicit SiteIndex(const sites::SitesData& sites);
};

/// What became of the pairs; see RasterReport.
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

/// Whether a site with this box is farther from the node than its bound.
[[nodiscard]] bool beyond(const tree::FloatBox& site, const DomainTree& tree, std::uint32_t node,
                          PairCounts& counts);

/// Descends the block's subtree with one site. `Polygons` says what is drawn: box(region) contains it, and
/// add(batch, region, box, domain) adds it, unless it is empty, and returns whether it did.
template <class Polygons>
class SiteDescent {
 public:
  using Batch = typename Polygons::Batch;

  SiteDescent(const DomainTree& tree, const DomainBlock& block, const SiteRegion& region,
              const Polygons& polygons, Batch& batch, PairCounts& counts)
      : tree_(tree),
        block_(block),
        region_(region),
        polygons_(polygons),
        batch_(batch),
        counts_(counts),
        box_(tree::FloatBox::around(region.box())),
        oriented_(polygons.box(region)) {}

  void run() { visit(tree_.tree, {block_.node, block_.end}, *this); }

  bool enter(tree::Subtree below) {
    if (beyond(box_, tree_, below.root, counts_)) {
      counts_.culled_by_bound += tree_.leaves.count(below);
      return false;
    }
    ++counts_.obb_tests;
    if (may_meet(oriented_, tree_.tree.box(below.root))) return true;
    counts_.culled_by_obb += tree_.leaves.count(below);
    return false;
  }

  void leaf(std::uint32_t leaf) {
    const std::uint32_t position = tree_.leaves.count(block_.node, leaf);
    const bool drawn = polygons_.add(batch_, region_, oriented_, block_.domains[position]);
    ++(drawn ? counts_.polygons : counts_.clipped_away);
  }

 private:
  const DomainTree& tree_;
  const DomainBlock& block_;
  const SiteRegion& region_;
  const Polygons& polygons_;
  Batch& batch_;
  PairCounts& counts_;
  tree::FloatBox box_;
  OrientedBox oriented_;
};

/// Adds the polygons of all sites of a leaf of O2's tree on the block's domains.
template <class Polygons>
void draw_leaf(const SiteIndex& index, std::uint32_t leaf, const DomainTree& tree, const DomainBlock& block,
               const Polygons& polygons, typename Polygons::Batch& batch, PairCounts& counts) {
  for_each_site(index.sites.regions, leaf, [&](const auto& site, std::size_t at) {
    if (!has_interior(site)) return;
    const SiteRegion region = region_of(index.sites, site, at);
    SiteDescent(tree, block, region, polygons, batch, counts).run();
  });
}

}  // namespace sdm::gl
