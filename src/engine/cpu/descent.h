// Closest sites of the points of a group: one traversal of O2's tree collects a list of sites for many
// points, and the lists of ever fewer points are filtered from it.
#pragma once

#include <vector>

#include "engine/cpu/point_group.h"
#include "engine/cpu/site_lists.h"
#include "hierarchy/traverse_wide.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

/// What a thread keeps between groups.
struct Descent {
  PointGroup points;
  std::uint32_t winners[PointGroup::kMostPoints];  ///< SiteId::packed of each point's closest site

  std::vector<hierarchy::OpenChild<float>> stack;
  std::vector<std::uint32_t> open, leaves, owners, edges, vertices;
  SiteLists gathered, lists[PointGroup::kLevels];
};

/// Finds the closest site within `limit` for every point of descent.points; one that is farther may be named
/// too. Selected in single precision: a winner can be another than the closest site only where the two differ
/// by rounding. Chooses the best vector instructions that the machine has, at run time.
void find_winners(const hierarchy::WideTree& tree, const sites::Regions& regions, float limit,
                  Descent& descent);

}  // namespace sdm::cpu
