#include "engine/gl/pair_culling.h"

#include "engine/gl/oriented_box.h"

namespace sdm::gl {
namespace {

double squared_distance(const hierarchy::FloatBox& a, const hierarchy::FloatBox& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({0.0, double{a.lo[k]} - b.hi[k], double{b.lo[k]} - a.hi[k]});
    sum += gap * gap;
  }
  return sum;
}

bool beyond(const hierarchy::FloatBox& site, const DomainTree& tree, std::uint32_t node, PairCounts& counts) {
  ++counts.bound_tests;
  const double bound = tree.bound[node];
  return squared_distance(site, tree.tree.nodes[node].box) > bound * bound;
}

// Descends the block's subtree with one site.
class Descent {
 public:
  Descent(const DomainTree& tree, const DomainBlock& block, const SiteRegion& region, double reach,
          const RasterScale& scale, RasterBatch& batch, PairCounts& counts)
      : tree_(tree),
        block_(block),
        region_(region),
        scale_(scale),
        batch_(batch),
        counts_(counts),
        box_(hierarchy::FloatBox::around(region.box())),
        oriented_(oriented_box(region, reach, scale.slack)) {}

  void visit(std::uint32_t node, std::uint32_t end) {
    if (beyond(box_, tree_, node, counts_)) {
      counts_.culled_by_bound += tree_.leaves.count(node, end);
      return;
    }
    ++counts_.obb_tests;
    const hierarchy::AabbTree::Node& n = tree_.tree.nodes[node];
    if (!may_meet(oriented_, n.box)) {
      counts_.culled_by_obb += tree_.leaves.count(node, end);
      return;
    }
    if (!n.leaf()) {
      visit(node + 1, n.right);
      visit(n.right, end);
      return;
    }
    const std::uint32_t position = tree_.leaves.count(block_.node, node);
    const bool drawn = add_polygon(batch_, region_, block_.domains[position], scale_);
    ++(drawn ? counts_.polygons : counts_.clipped_away);
  }

 private:
  const DomainTree& tree_;
  const DomainBlock& block_;
  const SiteRegion& region_;
  const RasterScale& scale_;
  RasterBatch& batch_;
  PairCounts& counts_;
  hierarchy::FloatBox box_;
  OrientedBox oriented_;
};

}  // namespace

SiteIndex::SiteIndex(const sites::SitesData& s) : sites(s), leaves(s.tree), before{0} {
  const std::size_t leaf_count = s.regions.bounds.size();
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    std::uint64_t kept = 0;
    for_each_site(s.regions, leaf,
                  [&](const auto& site, std::size_t) { ++(has_interior(site) ? kept : dropped); });
    before.push_back(before.back() + kept);
  }
}

PairCounts& PairCounts::operator+=(const PairCounts& other) {
  bound_tests += other.bound_tests;
  obb_tests += other.obb_tests;
  culled_by_bound += other.culled_by_bound;
  culled_by_obb += other.culled_by_obb;
  clipped_away += other.clipped_away;
  polygons += other.polygons;
  return *this;
}

std::vector<DomainBlock> cut_into_blocks(const DomainTree& tree, std::uint32_t size) {
  std::vector<DomainBlock> blocks;
  const auto cut = [&](auto&& self, std::uint32_t node, std::uint32_t end) -> void {
    if (tree.leaves.count(node, end) <= size) {
      blocks.push_back({node, end, {}});
      return;
    }
    const std::uint32_t right = tree.tree.nodes[node].right;
    self(self, node + 1, right);
    self(self, right, end);
  };
  cut(cut, 0, tree.node_count());
  return blocks;
}

std::vector<std::uint32_t> leaves_within_bound(const SiteIndex& index, const DomainTree& tree,
                                               const DomainBlock& block, PairCounts& counts) {
  std::vector<std::uint32_t> leaves;
  const auto& nodes = index.sites.tree.nodes;
  const std::uint64_t domains = tree.leaves.count(block.node, block.end);
  const auto walk = [&](auto&& self, std::uint32_t node, std::uint32_t end) -> void {
    if (beyond(nodes[node].box, tree, block.node, counts)) {
      const std::uint64_t sites =
          index.before[index.leaves.before[end]] - index.before[index.leaves.before[node]];
      counts.culled_by_bound += sites * domains;
    } else if (nodes[node].leaf()) {
      leaves.push_back(index.leaves.before[node]);
    } else {
      self(self, node + 1, nodes[node].right);
      self(self, nodes[node].right, end);
    }
  };
  walk(walk, 0, static_cast<std::uint32_t>(nodes.size()));
  return leaves;
}

void draw_leaf(const SiteIndex& index, std::uint32_t leaf, const DomainTree& tree, const DomainBlock& block,
               double reach, const RasterScale& scale, RasterBatch& batch, PairCounts& counts) {
  for_each_site(index.sites.regions, leaf, [&](const auto& site, std::size_t at) {
    if (!has_interior(site)) return;
    const SiteRegion region = region_of(index.sites, site, at);
    Descent(tree, block, region, reach, scale, batch, counts).visit(block.node, block.end);
  });
}

}  // namespace sdm::gl
