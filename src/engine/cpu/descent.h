// Closest sites of the points of a group: one traversal of O2's tree collects a list of sites for many
// points, and the lists of ever fewer points are filtered from it.
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

#include "engine/cpu/point_group.h"
#include "engine/cpu/site_lists.h"
#include "hierarchy/traverse_wide.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

/// The work done, which tests hold down.
struct DescentCounts {
  std::size_t groups = 0;       ///< traversals
  std::size_t nodes = 0;        ///< of the tree, tested
  std::size_t leaves = 0;       ///< of the tree, whose faces' bounds were tested
  std::size_t tree_sites = 0;   ///< that passed, and were tested one by one
  std::size_t list_blocks = 0;  ///< of eight sites, tested in lists
  std::size_t evaluations = 0;  ///< of a site for a packet

  DescentCounts& operator+=(const DescentCounts& other) {
    groups += other.groups, nodes += other.nodes, leaves += other.leaves;
    tree_sites += other.tree_sites, list_blocks += other.list_blocks, evaluations += other.evaluations;
    return *this;
  }
};

/// Per-thread state kept between groups.
struct Descent {
  PointGroup points;
  std::uint32_t winners[PointGroup::kMostPoints];  ///< SiteId::packed of each point's closest site
  DescentCounts counts;

  std::vector<hierarchy::OpenChild<float>> stack;
  std::vector<std::uint32_t> open, leaves, owners, edges, vertices;
  SiteLists gathered, lists[PointGroup::kLevels];
};

/// Finds the closest site within `limit` for every point of descent.points; one that is farther may be named
/// too. Selected in single precision: a winner can be another than the closest site only where the two differ
/// by rounding. Chooses the best vector instructions that the machine has, at run time.
void find_winners(const hierarchy::WideTree& tree, const sites::Regions& regions, float limit,
                  Descent& descent);

/// The work that it takes to find the winners of these points, at any distance: for tests and measurements.
[[nodiscard]] DescentCounts count_work(const sites::SitesData& sites, std::span<const Vec3> points);

}  // namespace sdm::cpu
