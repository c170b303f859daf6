#include "gl/pair_culling.h"

namespace sdm::gl {

bool beyond(const tree::FloatBox& site, const DomainTree& tree, std::uint32_t node, PairCounts& counts) {
  ++counts.bound_tests;
  const double bound = tree.bound[node];
  return squared_norm(gap(site, tree.tree.box(node))) > bound * bound;
}

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
  visit(tree.tree, tree::InOrder{[&](tree::Subtree below) {
                                   const bool small = tree.leaves.count(below) <= size;
                                   if (small) blocks.push_back({below.root, below.end, {}});
                                   return !small;
                                 },
                                 [](std::uint32_t) {}});
  return blocks;
}

std::vector<std::uint32_t> leaves_within_bound(const SiteIndex& index, const DomainTree& tree,
                                               const DomainBlock& block, PairCounts& counts) {
  std::vector<std::uint32_t> leaves;
  const tree::AabbTree& site_tree = index.sites.tree;
  const std::uint64_t domains = tree.leaves.count(block.node, block.end);
  const auto enter = [&](tree::Subtree below) {
    if (!beyond(site_tree.box(below.root), tree, block.node, counts)) return true;
    const std::uint64_t sites =
        index.before[index.leaves.before[below.end]] - index.before[index.leaves.before[below.root]];
    counts.culled_by_bound += sites * domains;
    return false;
  };
  visit(site_tree,
        tree::InOrder{enter, [&](std::uint32_t leaf) { leaves.push_back(index.leaves.before[leaf]); }});
  return leaves;
}

}  // namespace sdm::gl
