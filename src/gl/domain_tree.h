// The AABB tree of O1's domains, with an upper bound on distances at every node (the paper's 4.2).
#pragma once

#include <vector>

#include "gl/tile_tree.h"
#include "sites/sites_data.h"
#include "tree/fold.h"

namespace sdm::gl {

/// One domain per leaf. All coordinates are in the unit frame of O2.
struct DomainTree {
  tree::AabbTree tree;
  tree::LeafOrder leaves;
  std::vector<double> bound;  ///< of each node: no sample of its domains is farther from O2

  /// Refits the boxes to the current domains. Cost: linear.
  DomainTree(const Surface& surface, const TileTree& tiles, const UnitFrame& frame);

  [[nodiscard]] const tree::FloatBox& bounds() const { return tree.box(0); }
};

/// Sets the bound of every node to `bound`.
void set_bounds(DomainTree& tree, double bound);

/// Sets the bounds from one point of O2 for each leaf, the one closest to the centre of its box: no point of
/// the box is farther from it than the farthest corner is. The paper improves the bounds site by site, in an
/// order-dependent process that converges to these. Adds `slack`; bounds never exceed `largest`.
void set_bounds(DomainTree& tree, const sites::SitesData& sites, double slack, double largest);

}  // namespace sdm::gl
