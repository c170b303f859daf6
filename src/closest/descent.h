// Closest sites for groups of points: one traversal of O2's tree collects a candidate list for many points,
// from which the lists of smaller and smaller groups are filtered.
#pragma once

#include <vector>

#include "closest/point_group.h"
#include "closest/site_lists.h"
#include "tree/visit.h"

namespace sdm::closest {

/// Per-thread memory, reused between groups.
struct Descent {
  PointGroup points;
  std::uint32_t winners[PointGroup::kMostPoints];  ///< SiteId::packed of each point's closest site

  std::vector<tree::OpenNode> stack;
  std::vector<std::uint32_t> open, leaves, owners, edges, vertices;
  SiteLists gathered, lists[PointGroup::kLevels];
};

/// Finds the closest site within `limit` of every point of descent.points; a site beyond the limit may also
/// be returned. Selects in single precision: a winner can differ from the closest site only where the two
/// distances are equal up to rounding. Dispatches at run time to the best vector instructions of the machine.
void find_winners(const tree::WideTree& tree, const sites::Regions& regions, float limit, Descent& descent);

}  // namespace sdm::closest
